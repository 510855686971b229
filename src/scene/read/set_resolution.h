// One resolution for every optic of a scene.
#pragma once

#include "scene/data/scene.h"

namespace trilens {

/// Gives every optic this resolution, in the scene and in its resolved JSON. Throws InputError unless it is
/// in 1..1024, or where Scene::resolved is no scene's JSON; then nothing has changed.
void set_resolution(Scene& scene, int resolution);

}  // namespace trilens
