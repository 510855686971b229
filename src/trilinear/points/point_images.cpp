// Where a facet images a world point (Vallance 2005, chapter 3, listing 3.1), with polished roots.
#include "trilinear/points/point_images.h"

#include <algorithm>
#include <cmath>

#include "base/math/roots.h"

namespace trilens {
namespace {

// The point on the facet's rays as a function of (w1, w2, t), relative to o_0, and its derivatives.
struct Position {
    Vec3 point, by_w1, by_w2, by_t;
};

Position position(const Coplanarity& f, double w1, double w2, double t) {
    const Vec3 a = f.e1 + t * f.f1, b = f.e2 + t * f.f2;
    const Vec3 direction = f.direction + w1 * f.f1 + w2 * f.f2;
    return {t * f.direction + w1 * a + w2 * b, a, b, direction};
}

struct NewtonSolution {
    double w1, w2, t;
    Vec3 tolerance;  // of w0, w1, w2
    double t_tolerance;
    double residual;
};

// Newton steps on the three equations, for as long as they bring the point closer.
NewtonSolution polish(const Coplanarity& f, const Vec3& x, const Vec3& weights, double t) {
    NewtonSolution s{weights.y, weights.z, t, Vec3(0), 0, 0};
    Position p = position(f, s.w1, s.w2, s.t);
    s.residual = length(p.point - x);
    for (int step = 0; step < 3; ++step) {
        const Vec3 miss = x - p.point;
        const double det = triple(p.by_w1, p.by_w2, p.by_t);
        if (det == 0) break;
        const double w1 = s.w1 + triple(miss, p.by_w2, p.by_t) / det;
        const double w2 = s.w2 + triple(p.by_w1, miss, p.by_t) / det;
        const double next_t = s.t + triple(p.by_w1, p.by_w2, miss) / det;
        const Position next = position(f, w1, w2, next_t);
        const double residual = length(next.point - x);
        if (!(residual < s.residual)) break;
        s.w1 = w1, s.w2 = w2, s.t = next_t, s.residual = residual, p = next;
    }

    // How far rounding of the coordinates moves the solution: rows of the inverse of the derivative.
    const double det = std::fabs(triple(p.by_w1, p.by_w2, p.by_t));
    const double rounding =
        kCoordinateRounding * (length(f.origin) + length(x) + std::fabs(s.t) * length(p.by_t));
    const auto moved = [&](const Vec3& row) { return det > 0 ? length(row) * rounding / det : kLooseWeight; };
    const Vec3 by_w1 = cross(p.by_w2, p.by_t), by_w2 = cross(p.by_t, p.by_w1);
    s.tolerance = Vec3(moved(by_w1 + by_w2), moved(by_w1), moved(by_w2));
    s.tolerance = kWeightTolerance + glm::min(s.tolerance, Vec3(kLooseWeight));
    s.t_tolerance = std::min(moved(cross(p.by_w1, p.by_w2)), kLooseWeight * std::fabs(t));
    return s;
}

}  // namespace

PointImages point_images(const Coplanarity& facet, const Vec3& point, const ImageFilter& filter) {
    PointImages images;
    const Vec3 x = point - facet.origin;
    const double size = length(x) + length(facet.e1) + length(facet.e2);
    double previous = NAN;
    for (const double root : real_roots(coplanarity_cubic(facet, point))) {
        if (root == previous) continue;
        previous = root;
        if (!filter.behind && root < 0 && -root * length(facet.direction) > kLooseWeight * size) continue;

        const std::optional<Vec3> weights = weights_in_parametric_triangle(facet, root, point);
        if (!weights) continue;
        const NewtonSolution s = polish(facet, x, *weights, root);
        if (!(s.residual <= kImageResidual * size)) continue;
        const Vec3 w(1 - s.w1 - s.w2, s.w1, s.w2);
        const bool inside = w.x >= -s.tolerance.x && w.y >= -s.tolerance.y && w.z >= -s.tolerance.z;
        const bool ahead = s.t >= -s.t_tolerance;
        if ((!inside && !filter.whole_plane) || (!ahead && !filter.behind)) continue;
        const double t = filter.behind ? s.t : std::max(s.t, 0.0);
        images.image[static_cast<std::size_t>(images.count++)] = {t, w};
    }
    return images;
}

}  // namespace trilens
