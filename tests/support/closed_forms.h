// Where images lie by closed forms, for tests of what finds them.
#pragma once

#include <array>
#include <complex>
#include <optional>
#include <vector>

#include "base/raymesh/surface.h"
#include "camera/linear/linear_cameras.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"
#include "support/test_surfaces.h"

namespace trilens_test {

using Complex = std::complex<long double>;

/// All roots of c[0] + ... + c[4] z^4, by Durand and Kerner's simultaneous iteration.
inline std::array<Complex, 4> quartic_roots(const std::array<Complex, 5>& c) {
    std::array<Complex, 4> root;
    for (std::size_t k = 0; k < 4; ++k) root[k] = std::pow(Complex(0.4L, 0.9L), static_cast<int>(k) + 1);
    for (int round = 0; round < 500; ++round) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Complex z = root[k];
            Complex value = (((c[4] * z + c[3]) * z + c[2]) * z + c[1]) * z + c[0], rest = c[4];
            for (std::size_t other = 0; other < 4; ++other) {
                if (other != k) rest *= z - root[other];
            }
            root[k] = z - value / rest;
        }
    }
    return root;
}

/// Alhazen's problem: all points of the sphere where light from x is mirrored to e, on either side. In the
/// plane of e, x and the centre, with the sphere as unit circle and a, b for e and x: conj(ab) z^4 - conj(a +
/// b) z^3 + (a + b) z - ab = 0, |z| = 1.
inline std::vector<Vec3> alhazen(const CubeSphere& sphere, const Vec3& e, const Vec3& x) {
    const Vec3 from_center = (e - sphere.center) / sphere.radius, to = (x - sphere.center) / sphere.radius;
    const Vec3 axis = normalize(from_center), side = normalize(to - dot(to, axis) * axis);
    const Complex a(length(from_center), 0), b(dot(to, axis), dot(to, side));
    std::vector<Vec3> points;
    for (const Complex& z : quartic_roots({-a * b, a + b, 0, -std::conj(a + b), std::conj(a * b)})) {
        if (std::abs(std::abs(z) - 1) > 1e-12L) continue;
        if (((a - z) * (b - z) / (z * z)).real() < 0)
            continue;  // a and b on different sides: not a mirror image
        points.push_back(sphere.center + sphere.radius * (static_cast<double>(z.real()) * axis +
                                                          static_cast<double>(z.imag()) * side));
    }
    return points;
}

inline LinearCamera camera_at(const Vec3& eye, const Vec3& at) {
    PerspectiveParams params;
    params.look_at = {eye, at, {0.1, 1, 0.2}};
    params.width = params.height = 1000;
    return make_perspective(params);
}

inline Vec2 pixel_of(const LinearCamera& camera, const Vec3& point) {
    const Vec3 s = screen_from_world(camera, point);
    return Vec2(s) / s.z;
}

// A single ray mirrored or refracted where it met a surface: the single-ray laws at a hit, for tests to trace
// with.

/// Where a ray arrives at an interface between air (the side that the normals point to) and a body.
struct Arrival {
    trilens::Vec3 normal{0};  // unit, on the side that the ray comes from
    bool inside = false;      // it comes from within the body, against the normals
};

/// The hit's normal turned to face the ray.
inline Arrival arrival(const trilens::Ray& incoming, const trilens::SurfaceHit& hit) {
    const bool inside = dot(incoming.direction, hit.point.normal) > 0;
    return {inside ? -hit.point.normal : hit.point.normal, inside};
}

/// The mirrored ray: from the hit's point exactly (trace it with a t_min where it may meet the same surface),
/// with the length of the incoming direction. Either side of the surface mirrors.
inline trilens::Ray mirrored_ray(const trilens::Ray& incoming, const trilens::SurfaceHit& hit) {
    return {hit.point.position, trilens::mirrored(incoming.direction, hit.point.normal)};
}

/// The refracted ray, likewise; none on total internal reflection. `ior`: the body's refractive index over
/// that of the outside; rays that arrive from the front enter (eta = 1 / ior), rays that arrive from the back
/// leave (eta = ior).
inline std::optional<trilens::Ray> refracted_ray(const trilens::Ray& incoming, const trilens::SurfaceHit& hit,
                                                 double ior) {
    const Arrival at = arrival(incoming, hit);
    const std::optional<trilens::Vec3> direction =
        trilens::refracted(incoming.direction, at.normal, at.inside ? ior : 1 / ior);
    if (!direction) return std::nullopt;
    return trilens::Ray{hit.point.position, *direction};
}

}  // namespace trilens_test
