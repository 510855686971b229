// Where a scene edge meets the ruled surface that a facet's edge sweeps (Vallance 2005, chapter 5).
#include "trilinear/edge_sweep.h"

#include <algorithm>
#include <cmath>

#include "base/math/roots.h"
#include "trilinear/facet/coplanarity.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {
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
