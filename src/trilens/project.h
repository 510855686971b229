// Where world points appear: directly, in mirrors and through glass.
//
//     #include <trilens/scene.h>
//     const trilens::Renderer renderer(trilens::load_scene({"scene.json"}));
//     const std::vector<trilens::Vec3> points{{0.5, -0.5, 1.5}};
//     const std::vector<trilens::PointProjection> found = renderer.project(points);
//     for (const trilens::WorldImage& image : found[0].images)
//         std::printf("%s at %g, %g\n", trilens::path_name(image.path), image.pixel.x, image.pixel.y);
#pragma once

#include "render/project/project.h"
#include "scene/parameters.h"
#include "scene/samples/points_file.h"
#include "trilens/render.h"
