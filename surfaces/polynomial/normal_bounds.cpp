// The cross product's part along a normal from below, its part across from above.
#include "surfaces/polynomial/normal_bounds.h"

#include <algorithm>
#include <cmath>

namespace trilens {
namespace {

/// A hull as a ball, with its reach along the normal.
struct Reach {
    Vec3 middle{0};
    double radius = 0, longest = 0, along = 0;
};

Reach reach_of(std::span<const Vec3> hull, double slack, const Vec3& normal) {
    Reach reach;
    for (const Vec3& p : hull) reach.middle += p / static_cast<double>(hull.size());
    for (const Vec3& p : hull) {
        reach.radius = std::max(reach.radius, length(p - reach.middle) + slack);
        reach.longest = std::max(reach.longest, length(p) + slack);
        reach.along = std::max(reach.along, std::fabs(dot(p, normal)) + slack);
    }
    return reach;
}

}  // namespace

double normal_radius(const TangentHulls& hulls, const Vec3& normal) {
    const Reach u = reach_of(hulls.du, hulls.du_slack, normal);
    const Reach v = reach_of(hulls.dv, hulls.dv_slack, normal);

    // (a + alpha n) x (b + beta n), a and b across n, is a x b along n and beta a x n + alpha n x b across
    // it.
    const double moved = length(u.middle) * v.radius + length(v.middle) * u.radius + u.radius * v.radius;
    const double upright = dot(cross(u.middle, v.middle), normal) - moved;
    const double tangent = (v.along * u.longest + u.along * v.longest) / upright;
    if (!(upright > 0) || !std::isfinite(tangent)) return 2;

    // The chord 2 sin(angle / 2).
    const double cosine = 1 / std::sqrt(1 + tangent * tangent);
    return tangent * cosine * std::sqrt(2 / (1 + cosine)) + 1e-14;
}

}  // namespace trilens
