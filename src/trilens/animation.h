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

#include "image/apng.h"
#include "scene/animation.h"
#include "study/scenes.h"
