// Polynomials in u and v by their Bezier control points: values, derivatives, parts, interpolation.
#pragma once

#include <array>
#include <span>

#include "base/math/vec.h"

namespace trilens {

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

}  // namespace trilens
