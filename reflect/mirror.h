// The mirror law for one ray.
#pragma once

#include "base/math/vec.h"

namespace trilens {

/// The direction of the mirrored ray: d - 2 (d . n) n. Keeps the length of `incoming` (which points TO the
/// surface and need not be unit); `unit_normal` may point to either side.
inline Vec3 mirrored(const Vec3& incoming, const Vec3& unit_normal) {
    return incoming - 2.0 * dot(incoming, unit_normal) * unit_normal;
}

}  // namespace trilens
