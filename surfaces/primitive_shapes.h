// The shapes of primitives in their own frame: z along the axis, x along the tangent, the origin at the
// centre.
#pragma once

#include <array>
#include <memory>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// A shape given by one equation of degree 1 or 2 and cut off by its faces' domains.
class PrimitiveShape {
  public:
    virtual ~PrimitiveShape() = default;
    virtual std::size_t face_count() const = 0;
    virtual FaceBorder border(Id face) const = 0;

    /// The point with derivatives and unit normal, at (u, v) inside the domain.
    virtual SurfacePoint eval(Id face, const Vec2& uv) const = 0;

    /// Where the equation is known best: a ray that is given to it begins at its point nearest to there.
    virtual Vec3 equation_center() const { return Vec3(0); }
    /// The equation along a ray: c[0] + 2 c[1] t + c[2] t^2 is zero where the ray meets the uncut shape.
    virtual std::array<double, 3> equation(const Ray& ray) const = 0;

    /// The face and (u, v) of a point of the uncut shape; face kNone where it is cut off.
    virtual SurfaceParameter place(const Vec3& point) const = 0;
    /// Whether it is not cut off there.
    virtual bool has(const Vec3& point) const { return place(point).face != kNone; }
};

/// The shape of a checked primitive.
std::unique_ptr<PrimitiveShape> make_primitive_shape(const PrimitiveKind& kind);

}  // namespace trilens
