#include "intersect/triangle_hit.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace trilens {

// Watertight intersection in double: shear the ray onto an axis, then compare signed areas in two dimensions.

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

// The inside by areas, else the nearest of three edges.

NearestToOrigin nearest_to_origin(const PlaneTriangle& p) {
    const Vec3 areas(area_from_origin(p[1], p[2]), area_from_origin(p[2], p[0]),
                     area_from_origin(p[0], p[1]));
    const double sum = areas.x + areas.y + areas.z;
    const Vec3 weights = areas / sum;
    if (sum != 0 && weights.x >= 0 && weights.y >= 0 && weights.z >= 0) return {weights, 0};

    NearestToOrigin best;
    for (int k = 0; k < 3; ++k) {
        const Vec2 a = p[k], edge = p[(k + 1) % 3] - a;
        const double size_2 = dot(edge, edge);
        const double share = size_2 > 0 ? std::clamp(-dot(a, edge) / size_2, 0.0, 1.0) : 0.0;
        const double distance = length(a + share * edge);
        if (distance < best.distance) {
            best = {Vec3(0), distance};
            best.weights[k] = 1 - share;
            best.weights[(k + 1) % 3] = share;
        }
    }
    return best;
}

}  // namespace trilens
