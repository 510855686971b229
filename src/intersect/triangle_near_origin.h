// How near a triangle in the plane comes to the origin: a facet seen along a ray.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/math/vec.h"

namespace trilens {

/// The corners, in either sense; they may lie on a line or in one point.
using PlaneTriangle = std::array<Vec2, 3>;

/// Twice the signed area of the triangle from the origin over a to b.
inline double area_from_origin(const Vec2& a, const Vec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Whether the origin is farther than this from the triangle for sure, by one edge's line; no division, no
/// root. What rounding does to areas is far below the room that is left for it; where it may have turned the
/// triangle's own, the triangle is as good as its edge.
inline bool is_surely_beyond(const PlaneTriangle& p, double distance) {
    constexpr double kRelative = 1 + 1e-6, kRounding = 1e-13;
    const std::array<double, 3> areas{area_from_origin(p[0], p[1]), area_from_origin(p[1], p[2]),
                                      area_from_origin(p[2], p[0])};
    const double sum = areas[0] + areas[1] + areas[2];
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 &a = p[k], &b = p[(k + 1) % 3];
        const double outside = sum > 0 ? -areas[k] : areas[k];
        const double edge = std::fabs(b.x - a.x) + std::fabs(b.y - a.y);  // or more
        if (outside > kRelative * distance * edge + kRounding * (dot(a, a) + dot(b, b))) return true;
    }
    return false;
}

/// The triangle's point that is nearest to the origin: weights of its corners, and how far it is; 0 where the
/// origin lies inside.
struct NearestToOrigin {
    Vec3 weights{0};
    double distance = std::numeric_limits<double>::infinity();
};
NearestToOrigin nearest_to_origin(const PlaneTriangle& p);

}  // namespace trilens
