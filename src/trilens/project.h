// Where world points appear: directly, in mirrors and through glass.
//
//     const trilens::Renderer renderer(trilens::load_scene({"scene.json"}));
//     const std::vector<trilens::Vec3> points{{0.5, -0.5, 1.5}};
//     for (const trilens::WorldImage& image : renderer.project(points)[0].images)
//         std::printf("%s at %g, %g\n", trilens::path_name(image.path), image.pixel.x, image.pixel.y);
#pragma once

#include "render/project.h"
#include "trilens/render.h"
