// Bounds of surfaces that are polynomials over dyadic parts of their faces, as limit surfaces are, and of
// their normals.
#pragma once

#include <memory>
#include <mutex>
#include <span>

#include "base/math/vec.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// Bounds by convex hulls of Bezier control points (Farin, Curves and Surfaces for CAGD). Each face is taken
/// apart into dyadic squares (or triangles, where its domain is one) on which it is one polynomial: of degree
/// 3 in u and in v on squares, of total degree 4 on triangles. That a part is one is found by interpolating
/// and comparing with the surface at other points; the difference, which is rounding, widens the bounds.
std::unique_ptr<const SurfaceBounder> make_polynomial_bounder(const Surface& surface);

/// The same of one surface, made once for all who hold it at a time: it is large. Thread-safe.
class SharedPolynomialBounder {
  public:
    std::unique_ptr<const SurfaceBounder> get(const Surface& surface) const;

  private:
    mutable std::mutex making_;
    mutable std::weak_ptr<const SurfaceBounder> made_;
};

// How far normals turn where du and dv stay within their bounds.

/// The largest distance between `normal` (unit) and the unit vectors along du x dv, for all du in the convex
/// hull of `du`, widened by du_slack, and dv likewise; 2 where du and dv may become parallel or turn around.
struct TangentHulls {
    std::span<const Vec3> du, dv;
    double du_slack = 0, dv_slack = 0;
};
double normal_radius(const TangentHulls& hulls, const Vec3& normal);

}  // namespace trilens
