// A scene file's "lenses": prescriptions whose bodies and stops become meshes, and whose glasses materials.
#pragma once

#include "json/json.h"
#include "scene/read/reading.h"

namespace trilens {

/// Replaces `lenses` of a scene by what they are made of, behind its own meshes and materials: each body of
/// glass an optic NAME/1, NAME/2, ..., the stop in air a black ring NAME/stop, as wide as a quarter more than
/// the widest surface. What is wrong with a lens is told by its place there. Throws InputError for `lenses`
/// that the schema does not allow, and for lenses that cannot be made.
void expand_lenses(Json& scene, Reading& reading);

}  // namespace trilens
