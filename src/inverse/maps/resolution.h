// Resolution of a map: the singular values of its derivative, per unit of what it maps from.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/math/vec.h"

namespace trilens {

struct Resolution {
    double least = 0, most = 0;  // in the direction that is resolved worst, and best
};

/// The singular values of a 2 x 2 matrix.
inline Resolution singular_values(const Mat2& a) {
    const double squares = dot(a[0], a[0]) + dot(a[1], a[1]);
    const double determinant = a[0].x * a[1].y - a[1].x * a[0].y;
    const double root = std::sqrt(std::max(0.0, squares * squares - 4 * determinant * determinant));
    const double most = std::sqrt(0.5 * (squares + root));
    return {most > 0 ? std::fabs(determinant) / most : 0, most};
}

/// Of a map with this jacobian per pixel, where a pixel's sides are the tangent vectors dx and dy: pixels of
/// the map's range per unit of length along the tangent plane. Zero where the sides are parallel.
inline Resolution resolution_of(const Mat2& jacobian, const Vec3& dx, const Vec3& dy) {
    const double r11 = length(dx);
    if (!(r11 > 0)) return {};
    const double r12 = dot(dx, dy) / r11, r22 = length(cross(dx, dy)) / r11;  // (dx dy) = Q R
    if (!(r22 > 0)) return {};
    const Vec2 first = jacobian[0] / r11;
    return singular_values(Mat2(first, (jacobian[1] - r12 * first) / r22));
}

}  // namespace trilens
