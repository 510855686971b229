// A ray: the points origin + t * direction with t >= 0.
#pragma once

#include "base/math/vec.h"

namespace trilens {

/// World frame. The direction is NOT unit: its length is the unit of t, and a choice that matters
/// (a corner ray keeps the eye-to-corner length, so that a flat mirror stays exact).
struct Ray {
    Vec3 origin{0};
    Vec3 direction{0};
};

}  // namespace trilens
