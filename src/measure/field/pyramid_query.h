// Packet traversal of a field pyramid: the cells that may show the points of neighbouring pixels.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "measure/field/field_cell_bounds.h"
#include "measure/field/field_pyramid.h"

namespace trilens {

/// Points that are looked for, each from its pixel and as far as it may lie from there; side by side in
/// lanes.
class PointPacket {
  public:
    static constexpr std::size_t kPoints = 64;

    void clear() { count = 0; }
    bool is_full() const { return count == kPoints; }
    /// `squared_reach`: pixels.
    void add(const FieldSample& wanted, double squared_reach);

    std::size_t count = 0;
    // Lanes from `count` on are anything.
    alignas(64) float point[3][kPoints];
    alignas(64) float pixel[2][kPoints];  // column, row
    alignas(64) float most[kPoints];      // the square of the reach, a little more
};

/// A cell, and which points of a packet it may show: bit i for point i.
struct CellOfMany {
    int column = 0, row = 0;
    std::uint64_t points = 0;
};

/// All cells whose own box (FieldPyramid::may_show) holds points that they are near enough to; now and then
/// one that is a little too far away.
void find_cells(const FieldPyramid& index, const PointPacket& packet, std::vector<CellOfMany>& cells);

/// Those of `points` that the cell may hold (FieldCellBounds::may_hold), and now and then one that it just
/// does not.
std::uint64_t held_by(const FieldCellBounds& reach, const PointPacket& packet, std::uint64_t points);

}  // namespace trilens
