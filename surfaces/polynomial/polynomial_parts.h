// A face taken apart into the dyadic squares or triangles on which it is one polynomial.
#pragma once

#include <array>
#include <vector>

#include "base/raymesh/surface.h"
#include "surfaces/polynomial/bezier_net.h"

namespace trilens {

/// A square or triangle of a face: the corner at which it starts and its signed extent along both parameters.
/// A triangle has its other corners at corner + (size, 0) and corner + (0, size), so a negative size turns it
/// by half a turn.
struct PartShape {
    Vec2 corner{0};
    double size = 1;

    Vec2 low() const { return glm::min(corner, corner + size); }
    Vec2 high() const { return glm::max(corner, corner + size); }
};

/// The six vectors of a SurfacePoint: position, du, dv, duu, duv, dvv.
inline constexpr std::size_t kQuantities = 6;
inline const std::array<Vec3 SurfacePoint::*, kQuantities> kQuantity = {
    &SurfacePoint::position, &SurfacePoint::du,  &SurfacePoint::dv,
    &SurfacePoint::duu,      &SurfacePoint::duv, &SurfacePoint::dvv};

/// One part of a face.
struct FacePart {
    PartShape shape;
    Vec3 origin{0};  // world frame: what the control points are relative to
    BezierNet net;  // the position - origin, over t with (u, v) = shape.corner + shape.size t; a polynomial's
    bool is_polynomial = false;               // else known by samples alone
    std::array<double, kQuantities> slack{};  // of a polynomial: rounding; else the spread about `middle`
    SurfacePoint middle;                      // of samples: the part's middle
    double normal_spread = 2;                 // of samples: of the unit normal about the middle's
};

/// The nets of the six quantities, derivatives by the net's own parameters.
std::array<BezierNet, kQuantities> part_nets(const BezierNet& net);

/// The part as a polynomial of degree 3 in u and in v (squares) or 4 in both together (triangles), or as
/// samples if it is none.
FacePart fit_part(const Surface& surface, Id face, const PartShape& shape);

}  // namespace trilens
