// Scenes: read from files and text, or built in memory.
//
//     trilens::SceneRequest request{"scene.json"};
//     request.overrides.push_back({"/film/width", "320"});
//     request.resolution = 16;
//     trilens::Scene scene = trilens::load_scene(request);
//     scene.meshes[0].resolution = 8;
#pragma once

#include "scene/data/check_scene.h"
#include "scene/data/scene.h"
#include "scene/examples/examples.h"
#include "scene/info.h"
#include "scene/load.h"
#include "study/scenes.h"
