// The area of a polygon by its fan of triangles.
#pragma once

#include <span>

#include "base/math/vec.h"

namespace trilens {

/// Of a simple polygon in the plane; negative where its corners run clockwise. 0 of fewer than 3 corners.
inline double polygon_area(std::span<const Vec2> corners) {
    double twice = 0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        twice += cross(corners[i] - corners[0], corners[i + 1] - corners[0]);
    return 0.5 * twice;
}

}  // namespace trilens
