// When is a point in the plane of the parametric triangle? A cubic in t (Vallance 2005, chapter 3).
#include "trilinear/facet/facet.h"

#include <algorithm>
#include <cmath>

namespace trilens {

Vec3 corner_difference(const Vec3& a, const Vec3& b) {
    const Vec3 d = a - b;
    return length(d) <= kSameCorner * std::max(length(a), length(b)) ? Vec3(0) : d;
}

Coplanarity make_coplanarity(const TrilinearFacet& facet) {
    const auto& [r0, r1, r2] = facet.corner;
    Coplanarity c;
    c.origin = r0.origin, c.direction = r0.direction;
    c.e1 = corner_difference(r1.origin, r0.origin), c.e2 = corner_difference(r2.origin, r0.origin);
    c.f1 = corner_difference(r1.direction, r0.direction),
    c.f2 = corner_difference(r2.direction, r0.direction);

    // (e1 + t f1) x (e2 + t f2), and what the moving base point p_0 = o_0 + t d_0 takes away.
    c.n0 = cross(c.e1, c.e2);
    c.n1 = cross(c.e1, c.f2) + cross(c.f1, c.e2);
    c.n2 = cross(c.f1, c.f2);
    c.c1 = -dot(c.n0, c.direction);
    c.c2 = -dot(c.n1, c.direction);
    c.c3 = -dot(c.n2, c.direction);
    return c;
}

double side_of_parametric_triangle(const Coplanarity& facet, double t, const Vec3& point) {
    const Vec3 normal = cross(facet.e1 + t * facet.f1, facet.e2 + t * facet.f2);
    return dot(normal, (point - facet.origin) - t * facet.direction);
}

std::optional<Vec3> weights_in_parametric_triangle(const Coplanarity& facet, double t, const Vec3& point) {
    const Vec3 a = facet.e1 + t * facet.f1, b = facet.e2 + t * facet.f2;
    const Vec3 normal = cross(a, b);
    const double area2 = dot(normal, normal), a2 = dot(a, a), b2 = dot(b, b);
    // Sides that are what rounding left of a convergence count as nothing.
    const double parts_a = length(facet.e1) + std::fabs(t) * length(facet.f1);
    const double parts_b = length(facet.e2) + std::fabs(t) * length(facet.f2);
    constexpr double kShare2 = kDegenerateArea * kDegenerateArea;
    if (!(area2 > kShare2 * a2 * b2) || !(a2 > kShare2 * parts_a * parts_a) ||
        !(b2 > kShare2 * parts_b * parts_b)) {
        return std::nullopt;
    }

    const Vec3 x = (point - facet.origin) - t * facet.direction;
    const double w1 = triple(normal, x, b) / area2, w2 = triple(normal, a, x) / area2;
    if (!std::isfinite(w1) || !std::isfinite(w2)) return std::nullopt;
    return Vec3(1 - w1 - w2, w1, w2);
}

}  // namespace trilens
