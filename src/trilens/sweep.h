// Sweeps: the error of the projection over any settings, in a folder that can be resumed.
//
//     trilens::SweepRequest request;
//     request.scene.file = "scene.json";
//     request.over = {{"engine", {"exact", "classic"}}, {"resolution", {"1..16:x2"}}};
//     request.folder = "results/scene";
//     const trilens::SweepSummary summary = trilens::run_sweep(request);
//     for (const trilens::SweepFit& fit : summary.fits)
//         if (fit.order) std::printf("%s %s: order %g\n", fit.layer.c_str(), fit.metric.c_str(), *fit.order);
//
//     request.loaded = trilens::parse_scene(trilens::scene_examples()[0].json);  // one in memory
//     request.folder = "results/memory";
//     trilens::plan_sweep(request);
//
//     for (const trilens::AxisKind& kind : trilens::axis_kinds()) std::printf("%s\n", kind.name.c_str());
#pragma once

#include "study/sweep.h"
#include "trilens/scene.h"
