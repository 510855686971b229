// Where a triangle on the screen lies: whether it may reach the film, and its area there.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

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

/// The area of a triangle of homogeneous screen positions, in square pixels: infinite where the eye's plane
/// passes through it, 0 where all of it lies behind the eye.
inline double screen_area(const std::array<Vec3, 3>& screen) {
    const auto behind = [](const Vec3& s) { return !(s.z > 0); };
    if (std::all_of(screen.begin(), screen.end(), behind)) return 0;
    if (std::any_of(screen.begin(), screen.end(), behind)) return std::numeric_limits<double>::infinity();
    const auto pixel = [&](std::size_t k) { return Vec2(screen[k]) / screen[k].z; };
    const Vec2 b = pixel(1) - pixel(0), c = pixel(2) - pixel(0);
    return 0.5 * std::fabs(b.x * c.y - b.y * c.x);
}

}  // namespace trilens
