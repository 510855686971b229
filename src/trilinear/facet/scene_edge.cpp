// A scene triangle's edges as the parametric triangle cuts them.
#include "trilinear/facet/scene_edge.h"

#include <algorithm>
#include <cmath>

#include "base/math/roots.h"
#include "trilinear/facet/facet.h"

namespace trilens {

bool canonically_before(const Vec3& a, const Vec3& b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

EdgePoint cut_edge(const Coplanarity& facet, double t, const Vec3& a, const Vec3& b) {
    if (canonically_before(b, a)) {
        const EdgePoint turned = cut_edge(facet, t, b, a);
        return {turned.to, turned.from, turned.point};
    }
    // The distances of both ends from the plane differ by the edge's own rise, which loses no digits when
    // they are close.
    const Vec3 normal = cross(facet.e1 + t * facet.f1, facet.e2 + t * facet.f2);
    const Vec3 base = facet.origin + t * facet.direction;
    const double rise = dot(normal, b - a);
    const double s = rise != 0 ? std::clamp(dot(normal, base - a) / rise, 0.0, 1.0) : 0.5;
    return {1 - s, s, a + s * (b - a)};
}

std::optional<ImageVertex> edge_cut(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    double t) {
    const EdgePoint cut = cut_edge(facet, t, triangle.from(edge), triangle.to(edge));
    const std::optional<Vec3> weights = weights_in_parametric_triangle(facet, t, cut.point);
    if (!weights) return std::nullopt;
    ImageVertex vertex{t, *weights, Vec3(0)};
    vertex.barycentric[static_cast<int>(edge)] = cut.from;
    vertex.barycentric[static_cast<int>((edge + 1) % 3)] = cut.to;
    return vertex;
}

// The lines of rays that vary linearly, as quadratics (mathematics, section 2).

LineQuadratic line_quadratic(const AffineRays& rays) {
    const auto& [o, d, w] = rays;
    LineQuadratic line;
    line.direction = {w[0] * d[0], w[0] * d[1] + w[1] * d[0], w[0] * d[2] + w[2] * d[0],
                      w[1] * d[1], w[1] * d[2] + w[2] * d[1], w[2] * d[2]};
    line.moment = {
        cross(o[0], d[0]), cross(o[0], d[1]) + cross(o[1], d[0]), cross(o[0], d[2]) + cross(o[2], d[0]),
        cross(o[1], d[1]), cross(o[1], d[2]) + cross(o[2], d[1]), cross(o[2], d[2])};
    return line;
}

// Where a scene edge meets the ruled surface that a facet's edge sweeps (Vallance 2005, chapter 5).

namespace {

// The facet's edge relative to a: at t it runs from base + t direction by e + t f.
struct Sweep {
    Vec3 base, direction, e, f, l;

    Sweep(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b)
        : base(first.origin - a),
          direction(first.direction),
          e(corner_difference(second.origin, first.origin)),
          f(corner_difference(second.direction, first.direction)),
          l(b - a) {}
};

// Newton steps on base + t direction + u (e + t f) = s l, for as long as they help.
struct Solution {
    double t, u, s;
};

Solution polish(const Sweep& w, Solution c) {
    const auto miss = [&](const Solution& x) {
        return x.s * w.l - (w.base + x.t * w.direction + x.u * (w.e + x.t * w.f));
    };
    for (int step = 0; step < 2; ++step) {
        const Vec3 by_t = w.direction + c.u * w.f, by_u = w.e + c.t * w.f, by_s = -w.l, m = miss(c);
        const double det = triple(by_t, by_u, by_s);
        if (det == 0) return c;
        const Solution next{c.t + triple(m, by_u, by_s) / det, c.u + triple(by_t, m, by_s) / det,
                            c.s + triple(by_t, by_u, m) / det};
        if (!(length(miss(next)) < length(m))) return c;
        c = next;
    }
    return c;
}

}  // namespace

bool canonically_before(const Ray& a, const Ray& b) {
    return a.origin != b.origin ? canonically_before(a.origin, b.origin)
                                : canonically_before(a.direction, b.direction);
}

std::array<double, 3> sweep_quadratic(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b) {
    // The difference of the moving columns replaces the second: (base + t direction) x (e + t f) . l.
    const Sweep w(first, second, a, b);
    return {triple(w.l, w.base, w.e), triple(w.l, w.base, w.f) + triple(w.l, w.direction, w.e),
            triple(w.l, w.direction, w.f)};
}

SweepCrossings sweep_crossings(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b) {
    const bool turn_rays = canonically_before(second, first), turn_edge = canonically_before(b, a);
    if (turn_rays || turn_edge) {
        SweepCrossings turned = sweep_crossings(turn_rays ? second : first, turn_rays ? first : second,
                                                turn_edge ? b : a, turn_edge ? a : b);
        for (SweepCrossing& c : turned.crossing) {
            if (turn_rays) std::swap(c.on_first, c.on_second);
            if (turn_edge) std::swap(c.on_a, c.on_b);
        }
        return turned;
    }

    const Sweep w(first, second, a, b);
    const std::array<double, 3> q = sweep_quadratic(first, second, a, b);
    SweepCrossings crossings;
    for (const double t : real_roots({q[0], q[1], q[2], 0})) {
        // Two lines in one plane: p + u v = s l.
        const Vec3 p = w.base + t * w.direction, v = w.e + t * w.f;
        const Vec3 across = cross(v, w.l);
        const double size2 = dot(across, across);
        if (!(size2 > kDegenerateArea * kDegenerateArea * dot(v, v) * dot(w.l, w.l))) continue;
        const Solution c =
            polish(w, {t, dot(cross(w.l, p), across) / size2, dot(cross(v, p), across) / size2});
        if (!std::isfinite(c.t) || !std::isfinite(c.u) || !std::isfinite(c.s)) continue;
        crossings.crossing[static_cast<std::size_t>(crossings.count++)] = {c.t, 1 - c.u, c.u, 1 - c.s, c.s};
    }
    if (crossings.count == 2 && crossings.crossing[1].t < crossings.crossing[0].t) {
        std::swap(crossings.crossing[0], crossings.crossing[1]);
    }
    return crossings;
}

}  // namespace trilens
