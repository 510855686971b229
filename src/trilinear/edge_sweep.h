// Where a scene edge meets the ruled surface that a facet's edge sweeps (Vallance 2005, chapter 5).
#pragma once

#include <array>

#include "base/raymesh/ray.h"

namespace trilens {

/// A point of a scene edge lies at `t` on a ray between two corner rays. Both are given by two weights that
/// sum to 1.
struct SweepCrossing {
    double t = 0;
    double on_first = 1, on_second = 0;  // of the corner rays
    double on_a = 1, on_b = 0;           // of the scene edge's ends
};

/// Up to two crossings, t ascending.
struct SweepCrossings {
    int count = 0;
    std::array<SweepCrossing, 2> crossing;

    const SweepCrossing* begin() const { return crossing.data(); }
    const SweepCrossing* end() const { return crossing.data() + count; }
};

/// The coefficients, constant first, of det[o_0 + t d_0 - a, o_1 + t d_1 - a, b - a]: zero where the points
/// of both rays at t and the scene edge lie in one plane. Only two of the three columns move, so the equation
/// is quadratic in t; the cubic of coplanarity is that of one point and three rays.
std::array<double, 3> sweep_quadratic(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b);

/// Every crossing of the lines through both edges, for any t, u and s. None where they are parallel at that
/// t. Computed from one end whichever way the edges are given: exchanging `first` and `second` exchanges u
/// and 1 - u, exchanging a and b exchanges s and 1 - s, and t keeps every bit, so that facets that share an
/// edge cut the scene at the same places.
SweepCrossings sweep_crossings(const Ray& first, const Ray& second, const Vec3& a, const Vec3& b);

/// A total order of corner rays.
bool canonically_before(const Ray& a, const Ray& b);

}  // namespace trilens
