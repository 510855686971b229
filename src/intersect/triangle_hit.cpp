// Watertight intersection in double: shear the ray onto an axis, then compare signed areas in two dimensions.
#include "intersect/triangle_hit.h"

#include <cmath>
#include <limits>

namespace trilens {

ShearedRay::ShearedRay(const Ray& ray) : origin_(ray.origin) {
    const Vec3 size = glm::abs(ray.direction);
    z_ = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    x_ = (z_ + 1) % 3;
    y_ = (z_ + 2) % 3;
    shear_x_ = ray.direction[x_] / ray.direction[z_];
    shear_y_ = ray.direction[y_] / ray.direction[z_];
    scale_z_ = 1 / ray.direction[z_];
}

std::optional<TriangleHit> ShearedRay::meet(const std::array<Vec3, 3>& corner) const {
    // Corners relative to the ray's origin, sheared so that the ray is the z axis. Each corner by itself, so
    // that triangles which share it get the same bits.
    std::array<Vec3, 3> p;
    for (int k = 0; k < 3; ++k) {
        const Vec3 local = corner[k] - origin_;
        p[k] = {local[x_] - shear_x_ * local[z_], local[y_] - shear_y_ * local[z_], local[z_]};
    }

    // Twice the signed areas of the origin with each edge; a corner's weight is the area opposite to it.
    const double area0 = p[2].x * p[1].y - p[2].y * p[1].x;
    const double area1 = p[0].x * p[2].y - p[0].y * p[2].x;
    const double area2 = p[1].x * p[0].y - p[1].y * p[0].x;
    const bool any_negative = area0 < 0 || area1 < 0 || area2 < 0;
    const bool any_positive = area0 > 0 || area1 > 0 || area2 > 0;
    if (any_negative && any_positive) return std::nullopt;
    const double area = area0 + area1 + area2;
    if (!(area != 0) || !std::isfinite(area)) return std::nullopt;

    const Vec3 weight = Vec3(area0, area1, area2) / area;
    const double t = scale_z_ * (weight.x * p[0].z + weight.y * p[1].z + weight.z * p[2].z);
    if (!std::isfinite(t)) return std::nullopt;
    return TriangleHit{t, {weight.y, weight.z}};
}

bool has_no_area(const std::array<Vec3, 3>& corner) {
    const Vec3 a = corner[1] - corner[0], b = corner[2] - corner[0];
    const double area = length(cross(a, b)), bound = length(a) * length(b);
    // Four roundings of relative size epsilon go into each component of the cross product.
    return !(area > 4 * std::numeric_limits<double>::epsilon() * bound) || !std::isfinite(bound);
}

}  // namespace trilens
