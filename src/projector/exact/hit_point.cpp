// The products of vectors, one triangle and one ray at a time.
#include "projector/exact/hit_point.h"

#include <cmath>

namespace trilens {

TriangleFrame triangle_frame(const std::array<Vec3, 3>& corner) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    return {corner[0], e1, corner[0] - corner[2], cross(e1, e2), largest_part(e1) * largest_part(e2)};
}

std::optional<LineHit> hit_point(const SampleRay& ray, const TriangleFrame& triangle) {
    const Vec3 from = ray.weight * triangle.corner - ray.origin;
    const double along = dot(triangle.normal, ray.direction), above = dot(triangle.normal, from);
    const Vec3 turn = cross(ray.direction, from);
    const double scale = 1 / (ray.weight * along);
    const double t = above * (ray.weight * scale);
    const double b1 = dot(triangle.turned, turn) * scale, b2 = dot(triangle.e1, turn) * scale;
    if (!(std::fabs(along) >= kLeastDeterminant * (largest_part(ray.direction) * triangle.size)))
        return std::nullopt;
    if (!(b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && std::isfinite(t))) return std::nullopt;
    return LineHit{t, {b1, b2}};
}

}  // namespace trilens
