// One ray and one triangle in double, without gaps between triangles that share an edge.
// Source: Woop, Benthin and Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013.
#pragma once

#include <array>
#include <optional>

#include "base/raymesh/ray.h"

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

}  // namespace trilens
