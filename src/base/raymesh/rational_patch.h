// Rational Bezier patches: places and derivatives, and the edges that neighbours share; Bernstein polynomials
// by products of linear polynomials in the shift operator (Farin, Curves and Surfaces for CAGD, chapter 5).
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"
#include "base/raymesh/surface.h"

namespace trilens {

// Bernstein polynomials: values, and blossoms for parts.

/// Weights on the control points of one direction, degrees below kMost.
template <std::size_t kMost>
using BezierWeights = std::array<double, kMost>;

/// One step of de Casteljau's algorithm at t: the weights times ((1 - t) + t E), E the shift by one.
template <std::size_t kMost>
void step(BezierWeights<kMost>& weights, double t) {
    for (std::size_t k = kMost - 1; k > 0; --k) weights[k] = (1 - t) * weights[k] + t * weights[k - 1];
    weights[0] *= 1 - t;
}

/// The blossom's weights for `count` arguments, those before `from_high` equal to high, the others to low.
template <std::size_t kMost>
BezierWeights<kMost> blossom(int count, int from_high, double low, double high) {
    BezierWeights<kMost> weights{1};
    for (int k = 0; k < count; ++k) step(weights, k < from_high ? high : low);
    return weights;
}

/// The Bernstein polynomials of a degree of at least 1 at t, their first and their second derivatives.
template <std::size_t kMost>
std::array<BezierWeights<kMost>, 3> bernstein(int degree, double t) {
    const auto raised = [&](const BezierWeights<kMost>& lower) {  // to the derivative's one degree more
        BezierWeights<kMost> weights{-lower[0]};
        for (std::size_t k = 1; k < kMost; ++k) weights[k] = lower[k - 1] - lower[k];
        return weights;
    };
    const double p = degree;
    BezierWeights<kMost> value = blossom<kMost>(degree - 2, degree - 2, t, t), second{};
    if (degree >= 2) {
        second = raised(raised(value));
        step(value, t);
    }
    BezierWeights<kMost> first = raised(value);
    step(value, t);
    for (std::size_t k = 0; k < kMost; ++k) {
        first[k] *= p;
        second[k] *= p * (p - 1);
    }
    return {value, first, second};
}

// Patches.

inline constexpr int kHighestPatchDegree = 9;
inline constexpr std::size_t kMostPatchRow = kHighestPatchDegree + 1;

/// The quotient of two polynomials over the unit square by their Bezier points (w (p - origin), w), which run
/// along u and then from row to row along v; weights w > 0, so that the points p have the patch in their
/// convex hull. [Farin, NURB Curves and Surfaces, 1995]
struct RationalPatch {
    int degree_u = 3, degree_v = 3;  // 1 .. kHighestPatchDegree
    Vec3 origin{0};                  // world frame, near the patch: small patches far away stay exact
    std::vector<Vec4> points;        // (degree_u + 1) (degree_v + 1)

    std::size_t row() const { return static_cast<std::size_t>(degree_u) + 1; }
    Vec3 control(std::size_t k) const { return origin + Vec3(points[k]) / points[k].w; }
};

/// The largest coordinate of a control point about the patch's origin.
double extent_of(const RationalPatch& patch);

/// Holds the patch.
Box bounds_of(const RationalPatch& patch);

/// The unit normal along du x dv of a face whose control points spread as far as `extent`; zero where that is
/// rounding and no direction.
Vec3 normal_of_tangents(const SurfacePoint& point, double extent);

/// Where that vanishes (collapsed edges, folded neighbourhoods) the normal is taken this share of the way
/// towards the middle of the face; the later ones serve derivatives that vanish to higher order.
inline constexpr std::array<double, 3> kStepsInward = {0x1p-20, 0x1p-12, 0x1p-6};

/// Position and derivatives at (u, v) of the unit square; the normal along du x dv, where that has no
/// direction that of a place beside it, towards the middle. `extent`: the patch's extent_of.
SurfacePoint evaluate(const RationalPatch& patch, const Vec2& uv, double extent);
/// The same bit for bit without second derivatives.
SurfacePoint evaluate_first_order(const RationalPatch& patch, const Vec2& uv, double extent);

// Sides are numbered as FaceBorder's.

/// Whether all of a side is one point, to rounding: as join_patches leaves it.
bool is_collapsed(const RationalPatch& patch, std::size_t side);

inline constexpr double kSameControl = 1e-9;  // a share: of a weight, or of the largest side of a box

/// How far apart points of patches within this box may lie and count as one; 0 for an empty box.
double joint_tolerance(const Box& all);

/// The borders of patches whose sides agree, point by point, in either direction, and weight by weight but
/// for a common factor. Tolerances: joint_tolerance of the box of all control points, kSameControl. Control
/// points of sides that agree, or that are one point, become the same, those of the first patch: no gap is
/// left.
std::vector<FaceBorder> join_patches(std::span<RationalPatch> patches);

}  // namespace trilens
