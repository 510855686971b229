// How far normals turn where du and dv stay within their bounds.
#pragma once

#include <span>

#include "base/math/vec.h"

namespace trilens {

/// The largest distance between `normal` (unit) and the unit vectors along du x dv, for all du in the convex
/// hull of `du`, widened by du_slack, and dv likewise; 2 where du and dv may become parallel or turn around.
struct TangentHulls {
    std::span<const Vec3> du, dv;
    double du_slack = 0, dv_slack = 0;
};
double normal_radius(const TangentHulls& hulls, const Vec3& normal);

}  // namespace trilens
