// Calibration: parameters of mirrors, glass and cameras from pairs of pixels and world points.
//
//     #include <trilens/fit.h>
//     const trilens::Scene scene = trilens::load_scene({"scene.json"});
//     trilens::FitRequest request;
//     request.free = {"/meshes/0/primitive/center", "/meshes/0/primitive/radius"};
//     const trilens::FitResult found =
//         trilens::fit_scene(scene, trilens::read_correspondences("pairs.csv"), request);
//     for (const trilens::FittedParameter& one : found.parameters)
//         std::printf("%s = %g +- %g\n", one.pointer.c_str(), one.value, one.sigma);
//     const trilens::Scene fitted = trilens::load_scene({"scene.json", found.changes});
#pragma once

#include "inverse/fit/fit.h"
#include "trilens/scene.h"
