// Random facets, points and meshes of the kinds that occur: general, mirrors, pinholes, parallel rays.
#pragma once

#include <cmath>
#include <random>

#include "trilinear/facet/facet.h"

namespace trilens_test {

using trilens::Ray;
using trilens::TrilinearFacet;
using trilens::Vec3;

class Random {
  public:
    explicit Random(std::uint64_t seed) : engine_(seed) {}
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(engine_);
    }
    double log_uniform(double low, double high) { return std::exp(uniform(std::log(low), std::log(high))); }
    int below(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
    Vec3 in_box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
    Vec3 on_sphere() {
        for (;;) {
            const Vec3 v = in_box(1);
            const double l = trilens::length(v);
            if (l > 0.1 && l < 1) return v / l;
        }
    }
    /// Barycentric coordinates, uniform over the triangle.
    Vec3 weights() {
        const double a = std::sqrt(uniform(0, 1)), b = uniform(0, 1);
        return {1 - a, a * (1 - b), a * b};
    }

  private:
    std::mt19937_64 engine_;
};

enum class FacetKind { kGeneral, kMirror, kConcave, kFlatMirror, kPinhole, kParallel, kCount };

/// A facet of size about one near the world's origin whose rays go away from it. Mirrors: three points of a
/// surface seen from `eye`, reflected with the eye-to-corner length.
inline TrilinearFacet random_facet(Random& random, FacetKind kind) {
    TrilinearFacet facet;
    const Vec3 eye = 3.0 * random.on_sphere() + 0.2 * random.on_sphere();
    const Vec3 flat_normal = trilens::normalize(eye), common = random.on_sphere();
    for (Ray& ray : facet.corner) {
        ray.origin = random.in_box(1), ray.direction = random.in_box(1);
        if (kind == FacetKind::kPinhole) ray.origin = Vec3(0.25, -0.5, 0.125);
        if (kind == FacetKind::kParallel) ray.direction = common;
        if (kind == FacetKind::kFlatMirror) ray.origin -= flat_normal * trilens::dot(flat_normal, ray.origin);
        const bool mirror =
            kind == FacetKind::kMirror || kind == FacetKind::kConcave || kind == FacetKind::kFlatMirror;
        if (!mirror) continue;
        // Bend a plane that faces the eye into a sphere of radius 2, then reflect.
        Vec3 normal = flat_normal;
        if (kind != FacetKind::kFlatMirror) {
            const double side = kind == FacetKind::kMirror ? 1 : -1;
            ray.origin = 0.6 * (ray.origin - flat_normal * trilens::dot(flat_normal, ray.origin));
            const Vec3 center = -2.0 * side * flat_normal;
            normal = trilens::normalize(ray.origin - center);
            ray.origin = center + 2.0 * normal;
            normal *= side;
        }
        const Vec3 incident = ray.origin - eye;
        ray.direction = incident - 2.0 * trilens::dot(incident, normal) * normal;
    }
    return facet;
}

/// A facet of a mirror that is a cylinder about the y axis, of radius 1 and seen from `eye`: two corners lie
/// on one line along the axis and share a normal, the third has the height of one of them.
inline TrilinearFacet cylinder_facet(Random& random, const Vec3& eye) {
    const double angle = std::atan2(eye.x, eye.z) + random.uniform(-1, 1),
                 step = random.log_uniform(0.02, 0.7);
    const double low = random.uniform(-1, 1), high = low + random.log_uniform(0.02, 1);
    const double other = random.below(2) ? low : high, turn = random.below(2) ? step : -step;
    const double angles[3] = {angle, angle, angle + turn}, heights[3] = {low, high, other};
    const int first = random.below(3);
    TrilinearFacet facet;
    for (int k = 0; k < 3; ++k) {
        const Vec3 normal(std::sin(angles[k]), 0, std::cos(angles[k]));
        const Vec3 point = normal + Vec3(0, heights[k], 0), incident = point - eye;
        facet.corner[static_cast<std::size_t>((first + k) % 3)] = {
            point, incident - 2.0 * trilens::dot(incident, normal) * normal};
    }
    return facet;
}

/// Three corners of a regular grid on the sphere of radius 1 about `center`, cols x rows cells in spherical
/// angles over the side that faces `eye`, as a mirror: a RayMesh with a plain screen (x = column, y = row, w
/// = 1).
inline trilens::RayMesh sphere_mirror(const Vec3& center, const Vec3& eye, int cols, int rows) {
    trilens::RayMesh mesh;
    const Vec3 z = trilens::normalize(eye - center);
    const Vec3 x = trilens::normalize(trilens::cross(z, Vec3(0.3, 1, 0.2))), y = trilens::cross(z, x);
    for (int j = 0; j <= rows; ++j) {
        for (int i = 0; i <= cols; ++i) {
            const double a = 1.2 * (2.0 * i / cols - 1), b = 1.2 * (2.0 * j / rows - 1);
            const Vec3 normal =
                std::sin(a) * std::cos(b) * x + std::sin(b) * y + std::cos(a) * std::cos(b) * z;
            const Vec3 point = center + normal, incident = point - eye;
            mesh.rays.push_back({point, incident - 2.0 * trilens::dot(incident, normal) * normal});
            mesh.screen.push_back(Vec3(i, j, 1));
        }
    }
    const auto at = [&](int i, int j) { return static_cast<trilens::Id>(j * (cols + 1) + i); };
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < cols; ++i) {
            mesh.facets.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.facets.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

}  // namespace trilens_test
