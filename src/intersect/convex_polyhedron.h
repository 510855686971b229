// Segments against a convex polyhedron: clipped by its faces' planes (Cyrus and Beck, Generalized
// two-dimensional line clipping, 1978).
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// A closed surface of flat faces that bounds a convex body.
class ConvexPolyhedron {
  public:
    /// None where the surface is no such one, or has more faces than it pays for.
    static std::optional<ConvexPolyhedron> of(const Surface& surface);

    /// Whether the ray meets the surface between t_min and t_max, in units of its direction; none where
    /// rounding may tell either: at an end of the stretch, or where it grazes an edge.
    std::optional<bool> meets(const Ray& ray, double t_min, double t_max) const;

  private:
    struct Plane {
        Vec3 normal{0};    // unit, outward
        double place = 0;  // along it, from the middle
    };
    std::vector<Plane> planes_;
    Vec3 middle_{0};
    double size_ = 0;  // farthest corner from the middle
};

}  // namespace trilens
