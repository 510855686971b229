// Interpolates a facet's corner rays with each part of its weights.
#include "projector/exact/exact_hit.h"

#include <cmath>

#include "base/math/side_of_edge.h"

namespace trilens {

FacetRays make_facet_rays(const FacetOnScreen& facet) {
    const IdTriple& corner = facet.mesh.facets[facet.facet];
    // The corner furthest in front of the camera: its projection lies on the facet.
    Id reference = corner[0];
    for (const Id c : corner) {
        if (facet.mesh.screen[c].z > facet.mesh.screen[reference].z) reference = c;
    }
    const Vec3& place = facet.mesh.screen[reference];

    FacetRays result;
    if (place.z > 0) result.screen = {place.x / place.z, place.y / place.z};
    result.centre = facet.mesh.rays[reference].origin;
    const std::array<Vec3, 3> e{facet.weights.unnormalised(result.screen.x, result.screen.y),
                                facet.weights.weights_from_screen[0], facet.weights.weights_from_screen[1]};
    for (std::size_t part = 0; part < 3; ++part) {
        for (int k = 0; k < 3; ++k) {
            const Ray& ray = facet.mesh.rays[corner[static_cast<std::size_t>(k)]];
            result.rays.origin[part] += e[part][k] * (ray.origin - result.centre);
            result.rays.direction[part] += e[part][k] * ray.direction;
            result.rays.weight[part] += e[part][k];
        }
    }
    return result;
}

// The products of vectors, one triangle and one ray at a time.

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

// Exact signs around one ray, and where on the triangle the ray's line passes.

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
