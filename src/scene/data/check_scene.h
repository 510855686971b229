// Whether a scene that was built in memory is one.
#pragma once

#include "scene/data/scene.h"

namespace trilens {

/// Throws InputError with the place of the first thing that no scene file could say: indices out of range,
/// arrays that do not fit together, numbers that are not finite, a film without pixels. Scenes from files
/// pass. Cages are checked where their limit surface is made.
void check_scene(const Scene& scene);

}  // namespace trilens
