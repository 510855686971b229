// The interval tests of cell_bounds.h on SIMD lanes: several points of one query at once.
#pragma once

#include <cstddef>
#include <cstdint>

#include "specular/cell_bounds.h"
#include "specular/specular_point.h"

namespace trilens {

inline constexpr std::size_t kPointLanes = 16;

/// Bit i is about lane i.
using LaneBits = std::uint32_t;

/// Points that lie close together, world frame.
struct PointLanes {
    alignas(64) double x[kPointLanes] = {};
    alignas(64) double y[kPointLanes] = {};
    alignas(64) double z[kPointLanes] = {};

    void set(std::size_t lane, const Vec3& point) {
        x[lane] = point.x;
        y[lane] = point.y;
        z[lane] = point.z;
    }
    Vec3 at(std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
};

struct LaneQuestion {
    bool reflects = true;
    PathIndices n;
    const PointLanes& points;
    LaneBits asked = 0;
};

/// For which of the lanes asked test_place says that the place is empty. The same bits with every instruction
/// set, but for rounding those of test_place.
LaneBits empty_lanes(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view);

/// A zero of the law for each of the lanes `known`, on a sphere.
struct ZeroLanes {
    PointLanes at;
    alignas(64) double along[kPointLanes] = {};  // h . normal there
    LaneBits known = 0;
};

/// For which of the lanes asked and known no other zero lies in a part of a sphere of this curvature; said
/// only where the law is far from singular in the whole part.
///
/// For zeros P and Q, h = a n(P) and b n(Q), and d = Q - P: n(Q) . d = -n(P) . d = curvature / 2 |d|^2, so
/// that (h(Q) - h(P)) . d = curvature (a + b) / 2 |d|^2. But h is the gradient of a convex function, the
/// optical path in all of space: that is no less than 0, and no more than |d|^2 times the most that h turns
/// along the chord.
LaneBits alone_lanes(const LaneQuestion& question, const PlaceBounds& place, const EyeView& view,
                     const ZeroLanes& zeros, double curvature);

/// A cell that the operator shrinks to this share has one zero at most: for two zeros p and q of it, 0 = J (p
/// - q), J a mean of the Jacobians between them, and no such mean is singular.
inline constexpr double kAloneShare = 0.9;

/// The interval Newton operator shrinks a cell to this share, so that Newton's method converges.
inline constexpr double kContraction = 0.5;

struct NewtonLanes {
    LaneBits leaves = 0;     // proven: the cell has no zero
    LaneBits contracts = 0;  // of the others: the operator shrinks the cell by half or more
    LaneBits open = 0;       // newton_bounds says neither, nor shrinks to kAloneShare, however it rounds
    LaneBits narrow = 0;     // newton_bounds says neither, but shrinks to kAloneShare, however it rounds
};

/// newton_bounds of a cell with these half sides, for the lanes asked.
NewtonLanes newton_lanes(const LaneQuestion& question, const CellTerms& cell, const Vec2& half);

}  // namespace trilens
