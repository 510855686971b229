// Pyramid of boxes over a position field, for nearest-point queries.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "measure/field/patch.h"
#include "measure/field/position_field.h"

namespace trilens {

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

}  // namespace trilens
