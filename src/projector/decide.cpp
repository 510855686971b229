// Exact signs around one ray, and where on the triangle the ray's line passes.
#include "projector/decide.h"

#include <algorithm>
#include <cmath>

#include "base/side_of_edge.h"

namespace trilens {
namespace {

double largest(const Vec3& v) {
    return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}

/// Cramer's rule for origin' + t direction' = weight (corner0 + b1 e1 + b2 e2).
std::optional<LineHit> by_cramers_rule(const SampleRay& ray, const std::array<Vec3, 3>& corner) {
    const Vec3 e1 = corner[1] - corner[0], e2 = corner[2] - corner[0];
    const Vec3 p = ray.origin - ray.weight * corner[0];
    const Vec3 q = cross(ray.direction, e2), r = cross(p, e1);
    const double determinant = dot(e1, q);
    const double size = largest(ray.direction) * (largest(e1) * largest(e2));
    const double scale = 1 / (determinant * ray.weight);
    const double t = dot(e2, r) * (ray.weight * scale);
    const double b1 = dot(p, q) * scale, b2 = dot(ray.direction, r) * scale;
    if (!(std::fabs(determinant) >= kLeastDeterminant * size)) return std::nullopt;
    if (!(b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && std::isfinite(t))) return std::nullopt;
    return LineHit{t, {b1, b2}};
}

}  // namespace

std::optional<LineHit> decide(const SampleRay& ray, const std::array<Vec3, 3>& corner) {
    const Vec3 speed = glm::abs(ray.direction);
    const int z = speed.x > speed.y ? (speed.x > speed.z ? 0 : 2) : (speed.y > speed.z ? 1 : 2);
    const int x = (z + 1) % 3, y = (z + 2) % 3;
    if (!(speed[z] > 0)) return std::nullopt;

    const Vec3& direction = ray.direction;
    std::array<Vec3, 3> flat;
    Vec3 t;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = ray.weight * corner[k] - ray.origin;
        flat[k] = {p[x] - direction[x] / direction[z] * p[z], p[y] - direction[y] / direction[z] * p[z], 1};
        t[static_cast<int>(k)] = p[z] / direction[z];
    }
    const int side = side_of_edge(flat[0], flat[1]);
    if (side == 0 || side_of_edge(flat[1], flat[2]) != side || side_of_edge(flat[2], flat[0]) != side)
        return std::nullopt;
    if (const std::optional<LineHit> hit = by_cramers_rule(ray, corner)) return hit;

    const auto area = [&](std::size_t a, std::size_t b) {
        return difference_of_products(flat[a].x, flat[b].y, flat[a].y, flat[b].x);
    };
    Vec3 share(area(1, 2), area(2, 0), area(0, 1));
    share /= share.x + share.y + share.z;
    return LineHit{dot(share, t), {share.y, share.z}};
}

}  // namespace trilens
