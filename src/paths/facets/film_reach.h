// Whether a triangle on the screen may reach the film.
#pragma once

#include <array>

#include "base/math/vec.h"

namespace trilens {

/// False where all of the triangle lies off one side of a film of that size (pixels; its low corner at the
/// origin), or behind the eye; true else, and by a pixel more on all sides. Homogeneous screen positions: a
/// triangle may pass through the eye's plane.
inline bool may_reach_film(const std::array<Vec3, 3>& screen, const Vec2& film) {
    constexpr double kMargin = 1;
    bool left = true, right = true, below = true, above = true, behind = true;
    for (const Vec3& s : screen) {
        left = left && s.x <= -kMargin * s.z;
        right = right && s.x >= (film.x + kMargin) * s.z;
        below = below && s.y <= -kMargin * s.z;
        above = above && s.y >= (film.y + kMargin) * s.z;
        behind = behind && !(s.z > 0);
    }
    return !(left || right || below || above || behind);
}

}  // namespace trilens
