// How much longer than the eye's a corner ray is after optics.
#pragma once

#include <algorithm>
#include <cmath>

namespace trilens {

/// The ray scale: the cube root of the solid angle that a bundle of rays has before optics, > 0, over that
/// which it has after them, >= 0 (mathematics, section 6); within 1/50 and 50, for a fold of the directions,
/// or a focus of the bundle, would make corner rays endless or nothing.
inline double ray_scale_of(double before, double after) {
    constexpr double kMostScale = 50;
    return after > 0 ? std::clamp(std::cbrt(before / after), 1 / kMostScale, kMostScale) : kMostScale;
}

}  // namespace trilens
