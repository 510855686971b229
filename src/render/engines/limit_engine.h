// Views of the exact surfaces: the limit truth.
#pragma once

#include "render/engines/engine.h"

namespace trilens {

/// Views that follow every sample's camera ray to the exact surface and on into the scene.
FacetViews make_limit_views(const World& world, CameraRays camera);

}  // namespace trilens
