// The shapes of primitives in their own frame: z along the axis, x along the tangent, the origin at the
// centre.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "base/description/optic_description.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// a b - c d with one rounding error of the result instead of one of the products (Kahan; Jeannerod et al.
/// 2013).
inline double difference_of_products(double a, double b, double c, double d) {
    const double cd = c * d;
    return std::fma(a, b, -cd) + std::fma(-c, d, cd);
}

/// The real t with c[0] + 2 c[1] t + c[2] t^2 = 0, ascending; infinite where there are fewer.
inline std::array<double, 2> quadric_roots(const std::array<double, 3>& c) {
    constexpr double kNoRoot = HUGE_VAL;
    // Most rays miss by more than the four roundings of the plain difference: they need no exact one.
    const double square = c[1] * c[1], product = c[0] * c[2];
    if (square - product < -1e-15 * (square + std::fabs(product))) return {kNoRoot, kNoRoot};
    const double discriminant = difference_of_products(c[1], c[1], c[0], c[2]);
    if (!(discriminant >= 0)) return {kNoRoot, kNoRoot};

    // Both roots from the sum that does not cancel: one is q / c2, their product c0 / c2.
    const double q = -(c[1] + std::copysign(std::sqrt(discriminant), c[1]));
    if (q == 0) return {c[2] != 0 ? 0 : kNoRoot, kNoRoot};
    const double near_zero = c[0] / q, other = c[2] != 0 ? q / c[2] : kNoRoot;
    return {std::min(near_zero, other), std::max(near_zero, other)};
}

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

/// Faces whose corners are numbered, so that equal corner pairs are one edge.
std::vector<FaceBorder> borders_of(const std::vector<std::array<Id, 4>>& face_corners);

// The shapes of checked primitives.
std::unique_ptr<PrimitiveShape> make_shape(const SpherePrimitive& sphere);
std::unique_ptr<PrimitiveShape> make_shape(const ParaboloidPrimitive& paraboloid);
std::unique_ptr<PrimitiveShape> make_shape(const CylinderPrimitive& cylinder);
std::unique_ptr<PrimitiveShape> make_shape(const ConePrimitive& cone);
std::unique_ptr<PrimitiveShape> make_shape(const PlanePrimitive& plane);

}  // namespace trilens
