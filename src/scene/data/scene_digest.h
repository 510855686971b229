// A digest of all that a scene says: tells whether pictures of it may have changed.
#pragma once

#include <string>

#include "scene/data/scene.h"

namespace trilens {

/// 16 hexadecimal digits that change with everything that a scene holds, wherever it was read or built; not
/// with where it came from (file, folder, label, files), its warnings, or its text (resolved).
std::string scene_digest(const Scene& scene);

/// The same of all that one mesh holds.
std::string mesh_digest(const Mesh& mesh);
/// And of one camera.
std::string camera_digest(const CameraDescription& camera);

}  // namespace trilens
