// Whether a scene has what a request names.
#pragma once

#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens {

/// Throws UsageError for a camera that the scene does not have, a resolution beyond 1..1024 (0: none is asked
/// for), or a largest error beyond 0..kMostMaxError.
void check_frame(const World& world, const FrameParams& frame);

}  // namespace trilens
