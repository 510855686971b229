// What bounds of a surface say about several points of one query, one in each lane of a vector.
#pragma once

#include <cstddef>
#include <cstdint>

#include "camera/specular_bounds.h"
#include "camera/specular_law.h"

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

struct NewtonLanes {
    LaneBits leaves = 0;     // proven: the cell has no zero
    LaneBits contracts = 0;  // of the others: the operator shrinks the cell by half or more
};

/// newton_bounds of a cell with these half sides, for the lanes asked.
NewtonLanes newton_lanes(const LaneQuestion& question, const CellTerms& cell, const Vec2& half);

}  // namespace trilens
