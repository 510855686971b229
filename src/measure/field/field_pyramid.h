// Pyramid of boxes over a position field, bounds of what its cells can show, and queries for nearest points.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"
#include "base/util/ids.h"
#include "measure/field/patch.h"
#include "measure/field/position_field.h"

namespace trilens {

struct FieldPyramid;

/// All points that patches from any corner of a cell show lie in the box, and between two planes across each
/// direction: those of the cell's own axes, for a cell that is long and oblique fills little of its box.
struct FieldCellBounds {
    struct Slab {
        float direction[3] = {0, 0, 0};
        float low, high;  // of dot(direction, point)
    };
    float low[3], high[3];  // low > high: it shows nothing
    Slab slabs[2];

    bool may_hold(const Vec3& point) const;
};

/// World frame, of the cell (column, row) .. (column + 1, row + 1) of pixel centres and the pieces that its
/// corners show, whole or triangle by triangle. `other`: as make_patch has it.
FieldCellBounds reach_of_cell(const FieldPyramid& index, const PositionField& other, int column, int row);

/// Values that many threads may ask for. What is not asked for takes the room of a pointer.
template <typename Value>
class LazyValues {
  public:
    explicit LazyValues(std::size_t count) : known_(std::make_unique<std::atomic<Value*>[]>(count)) {}

    /// The value that make() returns, always the same.
    template <typename Make>
    const Value& get(std::size_t index, Make&& make) {
        if (const Value* const found = known_[index].load(std::memory_order_acquire)) return *found;
        const Value made = make();
        const std::lock_guard guard(mutex_);
        // Another thread may have made it meanwhile.
        if (const Value* const found = known_[index].load(std::memory_order_relaxed)) return *found;
        values_.push_back(made);
        known_[index].store(&values_.back(), std::memory_order_release);
        return values_.back();
    }

  private:
    std::unique_ptr<std::atomic<Value*>[]> known_;
    std::mutex mutex_;          // of what follows
    std::deque<Value> values_;  // stay where they are
};

// Pyramid of boxes over a position field, for nearest-point queries.

/// The bounding boxes of four cells, or of four groups of cells: the children 2 x + 0, 1 and 2 y + 0, 1 of a
/// larger group. Empty: low > high.
struct BoxQuad {
    // GCC's and Clang's vectors: side by side whatever the instruction set.
    using Floats [[gnu::vector_size(16)]] = float;
    using Bits [[gnu::vector_size(16)]] = std::int32_t;
    Floats low[3], high[3];

    /// Bit i: box i (x + 2 y) holds the point, borders included. Exact for coordinates that are floats.
    unsigned holding(const Vec3& point) const {
        Bits inside = {1, 2, 4, 8};
        for (int k = 0; k < 3; ++k) {
            const float at = static_cast<float>(point[k]);
            const Floats all = {at, at, at, at};
            inside &= (low[k] <= all) & (all <= high[k]);
        }
        return static_cast<unsigned>(inside[0] | inside[1] | inside[2] | inside[3]);
    }
};

/// A field with its links, and a pyramid over its cells: cell (column, row), from (-1, -1), lies between
/// those two pixel centres and the next. Made once, then read by any thread. Holds the field's views, not its
/// image.
struct FieldPyramid {
    explicit FieldPyramid(PositionField without_links);

    /// Whether a cell's patch, seen from any corner, is all its 4 x 4 pixels (kWhole), even if it may show
    /// one triangle only (kWholeTriangle).
    static constexpr std::uint8_t kWhole = 1, kWholeTriangle = 2;
    std::uint8_t wholeness(int column, int row) const {
        return field.contains(column, row) ? patches[field.index(column, row)] : 0;
    }
    /// The patch of a cell that is kWhole.
    Patch whole_patch(int column, int row) const;
    /// The number of a cell, below cell_count().
    std::size_t cell_number(int column, int row) const {
        return static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(field.width + 1) +
               static_cast<std::size_t>(column + 1);
    }
    std::size_t cell_count() const {
        return static_cast<std::size_t>(field.width + 1) * static_cast<std::size_t>(field.height + 1);
    }
    /// Whether all four pixels of a cell are linked round it.
    bool is_linked_cell(int column, int row) const;
    /// Whether a cell's own box holds the point.
    bool may_show(const Vec3& point, int column, int row) const;

    struct Level {
        int columns = 0, rows = 0;         // of quads
        std::unique_ptr<BoxQuad[]> quads;  // not cleared before they are filled

        Level(int columns_, int rows_)
            : columns(columns_), rows(rows_), quads(std::make_unique_for_overwrite<BoxQuad[]>(size())) {}
        std::size_t size() const {
            return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
        }

        const BoxQuad& at(int column, int row) const { return quads[index(column, row)]; }
        BoxQuad& at(int column, int row) { return quads[index(column, row)]; }
        std::size_t index(int column, int row) const {
            return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                   static_cast<std::size_t>(column);
        }
    };

    PositionField field;
    FieldWindow shown;                  // every pixel that shows the layer
    std::vector<std::uint8_t> patches;  // per pixel, of the cell to its right and down
    // Level 0 holds the cells: the box of (column, row) is a child of quad ((column + 1) / 2, (row + 1) / 2).
    // The last level is one quad.
    std::vector<Level> levels;
};

// Packet traversal of a field pyramid: the cells that may show the points of neighbouring pixels.

/// Points that are looked for, each from its pixel and as far as it may lie from there; side by side in
/// lanes.
class FieldPointPacket {
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
void find_cells(const FieldPyramid& index, const FieldPointPacket& packet, std::vector<CellOfMany>& cells);

/// Those of `points` that the cell may hold (FieldCellBounds::may_hold), and now and then one that it just
/// does not.
std::uint64_t held_by(const FieldCellBounds& reach, const FieldPointPacket& packet, std::uint64_t points);

}  // namespace trilens
