// A scene triangle's edges as the parametric triangle cuts them: one point per t, the same for both of an
// edge's users; as conics where rays vary linearly (mathematics, section 2); and where they meet the ruled
// surface that a facet's edge sweeps.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "trilinear/facet/facet.h"

namespace trilens {

// A scene triangle's edges as the parametric triangle cuts them: one point per t, the same for both of an
// edge's users; and as conics where rays vary linearly (mathematics, section 2).

/// A triangle of the scene, world frame.
struct SceneTriangle {
    std::array<Vec3, 3> corner;

    /// Edge e runs from corner e to corner (e + 1) % 3.
    const Vec3& from(std::size_t edge) const { return corner[edge]; }
    const Vec3& to(std::size_t edge) const { return corner[(edge + 1) % 3]; }
    Vec3 point(const Vec3& barycentric) const {
        return barycentric.x * corner[0] + barycentric.y * corner[1] + barycentric.z * corner[2];
    }
};

/// A point of a scene triangle as a facet images it.
struct ImageVertex {
    double t = 0;         // on the ray, in units of its direction
    Vec3 weights{0};      // of the facet's corners, sum 1
    Vec3 barycentric{0};  // of the scene triangle's corners, sum 1
};

/// A total order of points, so that what two users of an edge compute starts from the same end.
bool canonically_before(const Vec3& a, const Vec3& b);

/// A point of an edge: the weights of its two ends, which sum to 1, and the point.
struct EdgePoint {
    double from = 1, to = 0;
    Vec3 point{0};
};

/// Where the plane of the parametric triangle at `t` cuts the line through `a` and `b`, for cuts between
/// them: clamped to the edge. Exchanging a and b exchanges the weights and changes no bit.
EdgePoint cut_edge(const Coplanarity& facet, double t, const Vec3& a, const Vec3& b);

/// The image of the cut of a triangle's edge at `t`; none where the parametric triangle is degenerate.
std::optional<ImageVertex> edge_cut(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    double t);

// A scene edge, seen through rays that vary linearly over a plane of parameters, images as a conic
// (mathematics, section 2).

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

// Where a scene edge meets the ruled surface that a facet's edge sweeps (Vallance 2005, chapter 5).

/// A point of a scene edge lies at `t` on a ray between two corner rays. Both are given by two weights that
/// sum to 1.
struct SweepCrossing {
    double t = 0;
    double on_first = 1, on_second = 0;  // of the corner rays
    double on_a = 1, on_b = 0;           // of the scene edge's ends
};

/// Up to two crossings, t ascending.
struct SweepCrossings {
    int count = 0;
    std::array<SweepCrossing, 2> crossing;

    const SweepCrossing* begin() const { return crossing.data(); }
    const SweepCrossing* end() const { return crossing.data() + count; }
};

/// The coefficients, constant first, of det[o_0 + t d_0 - a, o_1 + t d_1 - a, b - a]: zero where the points
/// of both rays at t and the scene edge lie in one plane. Only two of the three columns move, so the equation
/// is quadratic in t; the cubic of coplanarity is that of one point and three rays.
std::array<double, 3> sweep_quadratic(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b);

/// Every crossing of the lines through both edges, for any t, u and s. None where they are parallel at that
/// t. Computed from one end whichever way the edges are given: exchanging `first` and `second` exchanges u
/// and 1 - u, exchanging a and b exchanges s and 1 - s, and t keeps every bit, so that facets that share an
/// edge cut the scene at the same places.
SweepCrossings sweep_crossings(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b);

/// A total order of corner rays.
bool canonically_before(const Ray& a, const Ray& b);

}  // namespace trilens
