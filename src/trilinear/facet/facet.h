// A facet's three corner rays: one trilinear projection (Vallance 2005, chapters 2 and 3), and the cubic in t
// that says when a point is in the plane of the parametric triangle.
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// Three corner rays, world frame; directions are not unit. At every t the points origin + t * direction are
/// the corners of the parametric triangle, whose interior the facet's rays pass at that t.
struct TrilinearFacet {
    std::array<Ray, 3> corner;

    Vec3 corner_at(std::size_t k, double t) const { return corner[k].origin + t * corner[k].direction; }
    Vec3 origin(const Vec3& weights) const {
        return weights.x * corner[0].origin + weights.y * corner[1].origin + weights.z * corner[2].origin;
    }
    Vec3 direction(const Vec3& weights) const {
        return weights.x * corner[0].direction + weights.y * corner[1].direction +
               weights.z * corner[2].direction;
    }
    /// The world point at `t` on the ray of `weights` (which sum to 1; outside [0, 1] they extend the facet).
    Vec3 point(const Vec3& weights, double t) const { return origin(weights) + t * direction(weights); }
};

/// The corner rays of one facet of a mesh, which must have rays.
inline TrilinearFacet trilinear_facet(const RayMesh& mesh, std::size_t facet) {
    const IdTriple& c = mesh.facets[facet];
    return {{mesh.rays[c[0]], mesh.rays[c[1]], mesh.rays[c[2]]}};
}

// When is a point in the plane of the parametric triangle? A cubic in t whose coefficients are affine in the
// point.

/// What a facet's cubics share (Vallance 2005, section 3: precalculated coefficients).
/// With p_k(t) = o_k + t d_k and the normal n(t) = (p_1 - p_0) x (p_2 - p_0) = n0 + n1 t + n2 t^2,
///     F(t; X) = n(t) . (X - p_0(t)):
/// each coefficient is a dot product with X - o_0 plus a constant; that of t^3 is the same for all points.
/// Everything is relative to o_0, so that a facet far from the world's origin loses no digits.
struct Coplanarity {
    Vec3 origin{0}, direction{0};   // corner ray 0
    Vec3 e1{0}, e2{0};              // o_1 - o_0 and o_2 - o_0; zero where origins agree up to rounding
    Vec3 f1{0}, f2{0};              // d_1 - d_0 and d_2 - d_0; zero where directions agree up to rounding
    Vec3 n0{0}, n1{0}, n2{0};       // of the normal
    double c1 = 0, c2 = 0, c3 = 0;  // constants of the cubic
};

/// Origins (or directions) whose difference is below this share of their length are taken as equal, so that a
/// pinhole or parallel rays that come out of a computation stay what they are.
inline constexpr double kSameCorner = 1e-15;

/// a - b, or zero where they are equal in this sense.
Vec3 corner_difference(const Vec3& a, const Vec3& b);

Coplanarity make_coplanarity(const TrilinearFacet& facet);

/// The coefficients, constant first, of F(t; X); X in the world frame.
inline std::array<double, 4> coplanarity_cubic(const Coplanarity& facet, const Vec3& point) {
    const Vec3 x = point - facet.origin;
    return {dot(facet.n0, x), dot(facet.n1, x) + facet.c1, dot(facet.n2, x) + facet.c2, facet.c3};
}

/// Positive where `point` lies on the side of the parametric triangle at `t` that its normal (p1 - p0) x (p2
/// - p0) points to, negative on the other side, zero in its plane: twice the triangle's area times the
/// distance.
double side_of_parametric_triangle(const Coplanarity& facet, double t, const Vec3& point);

/// Barycentric coordinates, summing to 1, of `point`'s foot in the plane of the parametric triangle at `t`.
/// None where that triangle is degenerate (all rays in one line or point at that t).
std::optional<Vec3> weights_in_parametric_triangle(const Coplanarity& facet, double t, const Vec3& point);

/// A parametric triangle is degenerate where its area is below this share of the product of two of its sides,
/// or a side below this share of the terms whose difference it is.
inline constexpr double kDegenerateArea = 1e-11;

}  // namespace trilens
