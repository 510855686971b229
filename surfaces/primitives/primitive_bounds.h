// Bounds of primitives in closed form: how fast each quantity changes at most, times the way from the middle.
#pragma once

#include <memory>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// Bounds of `surface`, which is the primitive's as make_primitive_surface makes it.
std::unique_ptr<const SurfaceBounder> make_primitive_bounder(const PrimitiveKind& kind,
                                                             const Surface& surface);

}  // namespace trilens
