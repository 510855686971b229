// A scene edge, seen through rays that vary linearly over a plane of parameters, images as a conic
// (mathematics, section 2).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/math/vec.h"

namespace trilens {

/// Rays over a plane of parameters (u, v), unnormalised: with W = weight[0] + u weight[1] + v weight[2], and
/// likewise origin' and direction', the ray has origin origin' / W and direction direction' / W. A facet is
/// such a family over its screen (W varies: perspective) and over its weights (W = 1).
struct AffineRays {
    std::array<Vec3, 3> origin{}, direction{};
    std::array<double, 3> weight{};

    Vec3 origin_at(double u, double v) const { return origin[0] + u * origin[1] + v * origin[2]; }
    Vec3 direction_at(double u, double v) const { return direction[0] + u * direction[1] + v * direction[2]; }
    double weight_at(double u, double v) const { return weight[0] + u * weight[1] + v * weight[2]; }
};

/// The Pluecker coordinates of the rays' lines, times W^2: direction W direction', moment origin' x
/// direction'. Coefficients of 1, u, v, u^2, u v, v^2.
struct LineQuadratic {
    std::array<Vec3, 6> direction{}, moment{};
};

LineQuadratic line_quadratic(const AffineRays& rays);

/// On which side of an edge the line of the ray (u, v) passes, as a quadratic: zero on the edge's image.
/// Coefficients of 1, u, v, u^2, u v, v^2.
struct EdgeConic {
    std::array<double, 6> c{};

    double at(double u, double v) const {
        return c[0] + u * (c[1] + u * c[3] + v * c[4]) + v * (c[2] + v * c[5]);
    }
};

/// The side of the edge a -> b: W^2 direction . ((a - origin) x (b - origin)). Antisymmetric in a and b; the
/// three conics of a triangle's edges (01, 12, 20) have one sign where the ray's line meets the triangle,
/// their sum is W^2 n . direction with n = (p1 - p0) x (p2 - p0), and their shares of the sum are the
/// barycentrics of the corners opposite.
inline EdgeConic edge_conic(const LineQuadratic& line, const Vec3& a, const Vec3& b) {
    const Vec3 l = b - a, m = cross(a, b);
    EdgeConic conic;
    for (std::size_t k = 0; k < 6; ++k) conic.c[k] = dot(line.direction[k], m) + dot(line.moment[k], l);
    return conic;
}

struct Range {
    double low = 0, high = 0;
};

/// Bounds of the conic over the square [-1, 1]^2 (not tight; rounding not included).
inline Range range_over_square(const EdgeConic& conic) {
    const std::array<double, 6>& c = conic.c;
    const double swing = std::fabs(c[1]) + std::fabs(c[2]) + std::fabs(c[4]);
    return {c[0] - swing + std::min(0.0, c[3]) + std::min(0.0, c[5]),
            c[0] + swing + std::max(0.0, c[3]) + std::max(0.0, c[5])};
}

}  // namespace trilens
