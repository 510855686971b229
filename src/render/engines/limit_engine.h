// Viewer of the exact surfaces: the limit truth.
#pragma once

#include "render/engines/engine.h"

namespace trilens {

/// A viewer that follows every sample's camera ray to the exact surface and on into the scene.
std::unique_ptr<Viewer> make_limit_viewer(const World& world, CameraRays camera);

}  // namespace trilens
