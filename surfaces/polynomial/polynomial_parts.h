// A face taken apart into the dyadic squares or triangles on which it is one polynomial; polynomials in u and
// v by their Bezier control points: values, derivatives, parts, interpolation.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/raymesh/surface.h"

namespace trilens {

// Polynomials in u and v by their Bezier control points: values, derivatives, parts, interpolation.

/// The polynomial sum of point[j * (nu + 1) + i] B_i(u) B_j(v) over the unit square, B the Bernstein
/// polynomials of degrees nu and nv. The control points' convex hull holds all its values.
struct BezierNet {
    static constexpr int kHighest = 4;
    int nu = 0, nv = 0;
    std::array<Vec3, (kHighest + 1) * (kHighest + 1)> point{};

    std::span<const Vec3> points() const {
        return {point.data(), static_cast<std::size_t>((nu + 1) * (nv + 1))};
    }
};

/// The value at t, which may lie outside the unit square.
Vec3 value(const BezierNet& net, const Vec2& t);

/// The derivative by u (axis 0) or v (axis 1); zero for a degree of 0.
BezierNet derivative(const BezierNet& net, int axis);

/// The same polynomial over the box from low to high as over a unit square.
BezierNet restricted(const BezierNet& net, const Vec2& low, const Vec2& high);

/// The net of degree n in u and v, n <= kHighest, whose value at (nodes[i], nodes[j]) is values[j * (n + 1) +
/// i]; n + 1 different nodes.
BezierNet interpolating_net(std::span<const double> nodes, std::span<const Vec3> values);

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

/// The part as a polynomial of degree 3 in u and in v (squares) or 4 in both together (triangles); none if it
/// is not one.
std::optional<FacePart> polynomial_part(const Surface& surface, Id face, const PartShape& shape);

/// Adds to a polynomial's slack what rounding may take where the surface is evaluated.
void add_rounding(FacePart& part);

/// Whether the surface is within the slack of a polynomial part at t, in the part's own parameters.
bool agrees_at(const Surface& surface, Id face, const FacePart& part, const Vec2& t);

/// The part as samples.
FacePart sampled_part(const Surface& surface, Id face, const PartShape& shape);

}  // namespace trilens
