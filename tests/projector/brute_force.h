// What a ray sees by the shortest road: every triangle, in long double, with nothing shared with the
// projector.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"

namespace trilens_test {

using namespace trilens;
using Real = long double;
using Real3 = std::array<Real, 3>;

inline Real3 minus(const Real3& a, const Real3& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline Real inner(const Real3& a, const Real3& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline Real3 outer(const Real3& a, const Real3& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline Real size(const Real3& a) {
    return std::sqrt(inner(a, a));
}
inline Real3 real(const Vec3& a) {
    return {a.x, a.y, a.z};
}

struct RealRay {
    Real3 origin{}, direction{};
    Real weight_error = 0;  // rounding of the facet's weights in double: they cancel where the facet is thin
    Real corner_reach = 0, corner_speed = 0;  // of the corner rays, which the weights multiply
};

/// The facet's interpolated ray at a place of the screen.
inline RealRay ray_at(const RayMesh& mesh, std::size_t facet, const Vec2& screen) {
    const Vec3 e = facet_weights(mesh, facet).unnormalised(screen.x, screen.y);
    const Real sum = static_cast<Real>(e.x) + e.y + e.z;
    RealRay ray;
    const Mat3& from_screen = facet_weights(mesh, facet).weights_from_screen;
    for (int k = 0; k < 3; ++k) {
        ray.weight_error += 1e-15L * std::fabs(from_screen[0][k] * screen.x / sum);
        ray.weight_error += 1e-15L * std::fabs(from_screen[1][k] * screen.y / sum);
        ray.weight_error += 1e-15L * std::fabs(from_screen[2][k] / sum);
    }
    for (int k = 0; k < 3; ++k) {
        const Ray& corner = mesh.rays[mesh.facets[facet][static_cast<std::size_t>(k)]];
        for (int c = 0; c < 3; ++c) {
            ray.origin[static_cast<std::size_t>(c)] += e[k] / sum * corner.origin[c];
            ray.direction[static_cast<std::size_t>(c)] += e[k] / sum * corner.direction[c];
        }
    }
    for (const Id k : mesh.facets[facet]) {
        ray.corner_reach = std::fmax(ray.corner_reach, size(minus(real(mesh.rays[k].origin), ray.origin)));
        ray.corner_speed = std::fmax(ray.corner_speed, size(real(mesh.rays[k].direction)));
    }
    return ray;
}

/// Where the ray's line meets a triangle's plane (Moeller and Trumbore, Fast, Minimum Storage Ray/Triangle
/// Intersection, 1997), and how far rounding in double may have moved it.
struct PlaneHit {
    bool exists = false;
    Real t = 0;
    Real3 weight{};         // of the corners; all >= 0: inside
    Real weight_error = 0;  // what double arithmetic may differ by
    Real t_error = 0;

    Real least_weight() const { return std::fmin(weight[0], std::fmin(weight[1], weight[2])); }
    bool inside() const { return exists && least_weight() >= 0 && t >= 0; }
    /// Whether double arithmetic may decide otherwise.
    bool marginal() const {
        return !exists || std::fabs(least_weight()) <= weight_error || std::fabs(t) <= t_error;
    }
};

inline PlaneHit meet(const RealRay& ray, const TriangleScene& scene, std::size_t triangle) {
    const IdTriple& corner = scene.triangles[triangle];
    const Real3 a = minus(real(scene.points[corner[0]]), ray.origin);
    const Real3 b = minus(real(scene.points[corner[1]]), ray.origin);
    const Real3 c = minus(real(scene.points[corner[2]]), ray.origin);
    const Real3 ab = minus(b, a), ac = minus(c, a), p = outer(ray.direction, ac);
    const Real determinant = inner(ab, p);
    if (determinant == 0) return {};

    PlaneHit hit;
    hit.exists = true;
    const Real3 from_a{-a[0], -a[1], -a[2]}, q = outer(from_a, ab);
    hit.weight[1] = inner(from_a, p) / determinant;
    hit.weight[2] = inner(ray.direction, q) / determinant;
    hit.weight[0] = 1 - hit.weight[1] - hit.weight[2];
    hit.t = inner(ac, q) / determinant;

    // Double carries 1.1e-16 per step of terms as large as reach^2 |d|.
    const Real reach = std::fmax(std::fmax(size(a), ray.corner_reach), std::fmax(size(b), size(c)));
    const Real speed = std::fmax(size(ray.direction), ray.corner_speed);
    hit.weight_error = (1e-13L + ray.weight_error) * reach * reach * speed / std::fabs(determinant);
    hit.t_error = hit.weight_error * reach / size(ray.direction);
    return hit;
}

/// The first triangle along the ray: depths closer than kDepthTie go to the smaller (object, primitive).
inline std::size_t first_along(const std::vector<PlaneHit>& hits, const TriangleScene& scene) {
    Real nearest = INFINITY;
    for (const PlaneHit& hit : hits) {
        if (hit.inside()) nearest = std::fmin(nearest, hit.t);
    }
    std::size_t first = kNone;
    for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!hits[i].inside() || hits[i].t > nearest * (1 + static_cast<Real>(kDepthTie))) continue;
        const auto key = [&](std::size_t k) { return std::pair(scene.object[k], scene.primitive[k]); };
        if (first == kNone || key(i) < key(first)) first = i;
    }
    return first;
}

}  // namespace trilens_test
