// Watertight ray/triangle intersection in double (Woop, Benthin and Wald, JCGT 2(1), 2013), and how near a
// triangle in the plane comes to the origin.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// Where a ray's line meets a triangle.
struct TriangleHit {
    double t = 0;         // in units of the direction; any sign
    Vec2 barycentric{0};  // weights of the second and third corner
};

/// A ray made ready for many triangles: the frame in which it runs along its largest axis from the origin.
class ShearedRay {
  public:
    explicit ShearedRay(const Ray& ray);

    /// Where the ray's whole line meets the triangle, edges and corners included; none for a triangle that it
    /// sees edge-on or that has no area. Two triangles with a shared edge (same bits of both corners) never
    /// both miss a ray through it: each edge's sign is the same in both, and rounding turns a sign to zero at
    /// most, which counts as a hit. Depends on the corners' order only through rounding of t and the weights.
    std::optional<TriangleHit> meet(const std::array<Vec3, 3>& corner) const;

  private:
    Vec3 origin_{0};
    int x_ = 0, y_ = 1, z_ = 2;  // axes; the direction is largest along z_
    double shear_x_ = 0, shear_y_ = 0, scale_z_ = 0;
};

/// Whether the triangle has no area: corners that are not finite, coincide, or lie on one line to rounding.
bool has_no_area(const std::array<Vec3, 3>& corner);

/// The corners, in either sense; they may lie on a line or in one point.
using PlaneTriangle = std::array<Vec2, 3>;

/// Twice the signed area of the triangle from the origin over a to b.
inline double area_from_origin(const Vec2& a, const Vec2& b) {
    return a.x * b.y - a.y * b.x;
}

/// Whether the origin is farther than this from the triangle for sure, by one edge's line; no division, no
/// root. What rounding does to areas is far below the room that is left for it; where it may have turned the
/// triangle's own, the triangle is as good as its edge.
inline bool is_surely_beyond(const PlaneTriangle& p, double distance) {
    constexpr double kRelative = 1 + 1e-6, kRounding = 1e-13;
    const std::array<double, 3> areas{area_from_origin(p[0], p[1]), area_from_origin(p[1], p[2]),
                                      area_from_origin(p[2], p[0])};
    const double sum = areas[0] + areas[1] + areas[2];
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec2 &a = p[k], &b = p[(k + 1) % 3];
        const double outside = sum > 0 ? -areas[k] : areas[k];
        const double edge = std::fabs(b.x - a.x) + std::fabs(b.y - a.y);  // or more
        if (outside > kRelative * distance * edge + kRounding * (dot(a, a) + dot(b, b))) return true;
    }
    return false;
}

/// The triangle's point that is nearest to the origin: weights of its corners, and how far it is; 0 where the
/// origin lies inside.
struct NearestToOrigin {
    Vec3 weights{0};
    double distance = std::numeric_limits<double>::infinity();
};
NearestToOrigin nearest_to_origin(const PlaneTriangle& p);

}  // namespace trilens
