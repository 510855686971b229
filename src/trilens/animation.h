// Scenes that move: frames of an animation, turntables, animated pictures.
//
//     #include <trilens/image.h>
//     #include <trilens/render.h>
//     #include <trilens/scene.h>
//     const trilens::Scene scene = trilens::load_scene(trilens::SceneRequest{"scene.json"});
//     trilens::Renderer renderer(trilens::scene_at_frame(scene, 0));
//     for (int frame = 0; frame < 120; ++frame) {
//         renderer.change(trilens::scene_at_frame(scene, frame));
//         trilens::write_image("f." + std::to_string(frame) + ".exr", renderer.draw({}).image);
//     }
#pragma once

#include <span>
#include <vector>

#include "image/apng.h"
#include "scene/animation.h"
#include "scene/animation/animation_keys.h"

namespace trilens {

/// The scene as it is at a frame: see load_frame.
Scene scene_at_frame(const Scene& scene, double frame, std::span<const SceneOverride> changes = {});

}  // namespace trilens
