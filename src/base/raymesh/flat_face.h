// Flat faces whose places are bilinear in their parameters: Newton's method in the plane inverts them.
#pragma once

#include <array>
#include <optional>

#include "base/raymesh/surface.h"

namespace trilens {

/// The place of (u, v) is corner + u * by_u + v * by_v + u * v * by_both, and the normal is one all over.
class FlatFace {
  public:
    /// None where the face is not flat, has several normals or none, or its places are off by more than 1e-13
    /// of how far it reaches from the world's origin.
    static std::optional<FlatFace> of(const Surface& surface, Id face);

    /// Whether places are affine in their parameters, to that: parallelograms and triangles.
    bool is_affine() const { return is_affine_; }
    // Of the place; the normal is unit.
    const Vec3& corner() const { return corner_; }
    const Vec3& by_u() const { return by_u_; }
    const Vec3& by_v() const { return by_v_; }
    const Vec3& normal() const { return normal_; }

    /// The parameters of a place in its plane that is surely within the face; none elsewhere.
    std::optional<Vec2> parameters_of(const Vec3& place) const;

    /// As the surface's eval_first_order() answers, but for rounding.
    SurfacePoint point(const Vec2& uv) const;

  private:
    Vec2 in_plane(const Vec3& way) const { return {way[axes_[0]], way[axes_[1]]}; }

    FaceDomain domain_ = FaceDomain::kSquare;
    Vec3 corner_{0}, by_u_{0}, by_v_{0}, by_both_{0}, normal_{0};
    bool is_affine_ = false;
    std::array<int, 2> axes_{0, 1};  // coordinates that tell places of its plane apart
};

}  // namespace trilens
