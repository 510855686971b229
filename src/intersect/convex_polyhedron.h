// Rays against a convex polyhedron: clipped by its faces' planes (Cyrus and Beck, Generalized
// two-dimensional line clipping, 1978).
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/flat_face.h"
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

    /// The first hit with t > t_min; false where rounding may tell otherwise, near an edge too, or the faces
    /// are no FlatFace: nothing is known then.
    bool find_first_hit(const Ray& ray, double t_min, std::optional<SurfaceHit>& hit) const;

  private:
    struct Face {
        Id number = kNone;
        FlatFace flat;
    };
    struct Plane {
        Vec3 normal{0};           // unit, outward
        double place = 0;         // along it, from the middle
        std::vector<Face> faces;  // that lie in it; none where they are not known in closed form
    };
    struct Clipped;
    void add_face(const Surface& surface, Id face, const Plane& in);
    Clipped clip(const Ray& ray) const;
    bool find_hit(const Ray& ray, const Plane& plane, double t, std::optional<SurfaceHit>& hit) const;

    std::vector<Plane> planes_;
    Vec3 middle_{0};
    double size_ = 0;  // farthest corner from the middle
};

}  // namespace trilens
