// Area lights as objects: what one sees of them.
#pragma once

#include "scene/data/scene.h"

namespace trilens {

/// Adds an object of its shape for each light that is_visible, after the meshes: an unlit one of the light's
/// radiance, named as the light ("light" and its index where it has no name), its material likewise. The
/// triangles lie where the light's samples do, spheres and disks within them: 64 sides. A flat light's object
/// is as bright from behind, where it lights nothing.
void add_light_objects(Scene& scene);

}  // namespace trilens
