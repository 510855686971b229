// Exact signs around one ray, and where on the triangle the ray's line passes.
#include "projector/exact/exact_hit.h"

#include "base/math/side_of_edge.h"

namespace trilens {

std::optional<LineHit> exact_hit(const SampleRay& ray, const std::array<Vec3, 3>& corner) {
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
    if (const std::optional<LineHit> hit = hit_point(ray, triangle_frame(corner))) return hit;

    const auto area = [&](std::size_t a, std::size_t b) {
        return difference_of_products(flat[a].x, flat[b].y, flat[a].y, flat[b].x);
    };
    Vec3 share(area(1, 2), area(2, 0), area(0, 1));
    share /= share.x + share.y + share.z;
    return LineHit{dot(share, t), {share.y, share.z}};
}

}  // namespace trilens
