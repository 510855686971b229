// Rays through conicoids in space, each by its implicit equation in world coordinates: for tests, and with
// nothing in common with trilens' own frames, sags and Newton steps.
#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"

namespace trilens_test {

/// c (|q|^2 + k (q . a)^2) = 2 q . a with q from the vertex.
struct ImplicitSurface {
    trilens::Vec3 vertex, axis;  // axis: unit
    double curvature = 0, conic = 0;
    double before = 1, behind = 1;  // indices
    bool mirror = false;
};

/// On from the last surface, unit. The crossing nearer to the vertex counts.
inline std::optional<trilens::Ray> implicit_trace(const std::vector<ImplicitSurface>& surfaces,
                                                  trilens::Ray ray) {
    using trilens::Vec3;
    Vec3 p = ray.origin, d = normalize(ray.direction);
    for (const ImplicitSurface& s : surfaces) {
        const Vec3 q = p - s.vertex;
        const double c = s.curvature, k = s.conic, qa = dot(q, s.axis), da = dot(d, s.axis);
        const double A = c * (1 + k * da * da), B = c * (dot(q, d) + k * qa * da) - da,
                     C = c * (dot(q, q) + k * qa * qa) - 2 * qa;
        const double room = B * B - A * C;
        if (room < 0) return std::nullopt;
        // The roots are q / A and C / q.
        const double big = -(B + std::copysign(std::sqrt(room), B));
        double t = C / big;
        if (A != 0 && length(q + big / A * d) < length(q + t * d)) t = big / A;
        p += t * d;
        const Vec3 at = p - s.vertex;
        const Vec3 n = normalize(c * (at + k * dot(at, s.axis) * s.axis) - s.axis);
        const Vec3 across = d - dot(d, n) * n;
        if (s.mirror) {
            d = across - dot(d, n) * n;
        } else {
            const Vec3 bent = s.before / s.behind * across;
            if (dot(bent, bent) > 1) return std::nullopt;
            d = bent + std::copysign(std::sqrt(1 - dot(bent, bent)), dot(d, n)) * n;
        }
    }
    return trilens::Ray{p, d};
}

}  // namespace trilens_test
