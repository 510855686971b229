#include "measure/field/field_pyramid.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// How far the surface of a cell may leave the box of its corners, in steps between pixels: bulge, overshoot
/// and residual of a whole cell; of a cell that is partly extrapolated also the longer steps there.
constexpr double kWholeMargin = 0.35, kPartMargin = 4;

constexpr std::size_t kRowsAtOnce = 16;

BoxQuad empty_quad() {
    BoxQuad quad;
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 4; ++i) {
            quad.low[k][i] = std::numeric_limits<float>::infinity();
            quad.high[k][i] = -std::numeric_limits<float>::infinity();
        }
    }
    return quad;
}

/// Per pixel of a row the longest linked step; zero where it stands alone.
void longest_steps(const PositionField& field, const FieldWindow& shown, int row,
                   std::vector<double>& longest) {
    const std::size_t below = static_cast<std::size_t>(field.width);
    longest.assign(below, 0);
    for (int column = shown.x0; column < shown.x1; ++column) {
        const std::size_t i = field.index(column, row), x = static_cast<std::size_t>(column);
        const auto look = [&](bool linked, std::size_t j) {
            if (!linked) return 0.0;
            const double step = length(field.point(j) - field.point(i));
            longest[x] = std::max(longest[x], step);
            return step;
        };
        const double right = look(field.links[i] & PositionField::kRight, i + 1);
        if (right > 0) longest[x + 1] = std::max(longest[x + 1], right);
        look(field.links[i] & PositionField::kDown, i + below);
        if (row > 0) look(field.links[i - below] & PositionField::kDown, i - below);
    }
}

/// The boxes of a row of cells, each with the margin of its kind.
struct CellRow {
    const FieldPyramid& index;
    std::vector<double> above = {}, below = {};  // longest steps of the pixels in the two rows

    void add_corner(BoxQuad& quad, int child, int x, int y, double margin_steps, double longest) const {
        const PositionField& field = index.field;
        const std::size_t i = field.index(x, y);
        if (!field.sees(i)) return;
        const Vec3 p = field.point(i);
        const double margin = margin_steps * longest +
                              8 * static_cast<double>(std::numeric_limits<float>::epsilon()) * length(p);
        for (int k = 0; k < 3; ++k) {
            const float low = quad.low[k][child], high = quad.high[k][child];
            quad.low[k][child] = std::min(low, static_cast<float>(p[k] - margin));
            quad.high[k][child] = std::max(high, static_cast<float>(p[k] + margin));
        }
    }

    void fill(int row, FieldPyramid::Level& level) const {
        for (int column = index.shown.x0 - 1; column < index.shown.x1; ++column) {
            BoxQuad& quad = level.at((column + 1) / 2, (row + 1) / 2);
            const int child = (column + 1) % 2 + 2 * ((row + 1) % 2);
            const double steps = index.is_linked_cell(column, row) ? kWholeMargin : kPartMargin;
            for (int corner = 0; corner < 4; ++corner) {
                const int x = column + corner % 2, y = row + corner / 2;
                if (!index.field.contains(x, y)) continue;
                const std::vector<double>& longest = corner < 2 ? above : below;
                add_corner(quad, child, x, y, steps, longest[static_cast<std::size_t>(x)]);
            }
        }
    }
};

/// Only cells at pixels that show the layer have a box.
FieldPyramid::Level cell_level(const FieldPyramid& index) {
    FieldPyramid::Level level((index.field.width + 2) / 2, (index.field.height + 2) / 2);
    parallel_for(static_cast<std::size_t>(level.rows), kRowsAtOnce, [&](std::size_t first, std::size_t last) {
        const auto row_at = [&](std::size_t row) {
            return &level.at(0, 0) + row * static_cast<std::size_t>(level.columns);
        };
        std::fill(row_at(first), row_at(last), empty_quad());
        CellRow cells{index};
        const int begin = std::max(2 * static_cast<int>(first) - 1, index.shown.y0 - 1),
                  end = std::min(2 * static_cast<int>(last) - 1, index.shown.y1);
        if (begin >= end) return;
        if (begin >= 0) longest_steps(index.field, index.shown, begin, cells.below);
        for (int row = begin; row < end; ++row) {
            std::swap(cells.above, cells.below);
            if (row + 1 < index.field.height) longest_steps(index.field, index.shown, row + 1, cells.below);
            cells.fill(row, level);
        }
    });
    return level;
}

FieldPyramid::Level coarser(const FieldPyramid::Level& fine) {
    FieldPyramid::Level level((fine.columns + 1) / 2, (fine.rows + 1) / 2);
    const auto fill = [&](int column, int row) {
        BoxQuad quad = empty_quad();
        for (int child = 0; child < 4; ++child) {
            const int x = 2 * column + child % 2, y = 2 * row + child / 2;
            if (x >= fine.columns || y >= fine.rows) continue;
            const BoxQuad& from = fine.at(x, y);
            for (int k = 0; k < 3; ++k) {
                const BoxQuad::Floats &low = from.low[k], &high = from.high[k];
                quad.low[k][child] = std::min({low[0], low[1], low[2], low[3]});
                quad.high[k][child] = std::max({high[0], high[1], high[2], high[3]});
            }
        }
        level.at(column, row) = quad;
    };
    parallel_for(static_cast<std::size_t>(level.rows), kRowsAtOnce, [&](std::size_t first, std::size_t last) {
        for (int row = static_cast<int>(first); row < static_cast<int>(last); ++row)
            for (int column = 0; column < level.columns; ++column) fill(column, row);
    });
    return level;
}

/// Of a pixel's links those that stay on its triangle.
constexpr std::uint8_t kRightSame = 4, kDownSame = 8;

/// The links of every pixel, with kRightSame and kDownSame.
std::vector<std::uint8_t> links_on_triangles(const PositionField& field, const FieldWindow& shown) {
    std::vector<std::uint8_t> links = field.links;
    const std::size_t below = static_cast<std::size_t>(field.width);
    const auto look = [&](std::size_t i) {
        if (links[i] & PositionField::kRight && field.primitive_of(i) == field.primitive_of(i + 1))
            links[i] |= kRightSame;
        if (links[i] & PositionField::kDown && field.primitive_of(i) == field.primitive_of(i + below))
            links[i] |= kDownSame;
    };
    parallel_for(static_cast<std::size_t>(shown.y1 - shown.y0), kRowsAtOnce,
                 [&](std::size_t first, std::size_t last) {
                     for (int row = static_cast<int>(first); row < static_cast<int>(last); ++row)
                         for (int x = shown.x0; x < shown.x1; ++x) look(field.index(x, shown.y0 + row));
                 });
    return links;
}

/// Per pixel the wholeness of its cell. All 24 links within the 4 x 4 pixels connect every pixel with every
/// corner, and linked pixels show one object through one optic.
std::vector<std::uint8_t> whole_patches(const PositionField& field, const FieldWindow& shown) {
    const std::vector<std::uint8_t> links = links_on_triangles(field, shown);
    const std::size_t below = static_cast<std::size_t>(field.width);
    std::vector<std::uint8_t> whole(links.size(), 0);
    const auto has = [](unsigned all, unsigned some) { return (all & some) == some; };
    parallel_for(static_cast<std::size_t>(std::max(0, shown.y1 - shown.y0 - 3)), kRowsAtOnce,
                 [&](std::size_t first, std::size_t last) {
                     const std::size_t left = static_cast<std::size_t>(shown.x0),
                                       top = static_cast<std::size_t>(shown.y0);
                     for (std::size_t row = top + first; row < top + last; ++row) {
                         for (std::size_t x = left; x + 3 < static_cast<std::size_t>(shown.x1); ++x) {
                             const std::uint8_t* at = &links[row * below + x];
                             unsigned right = 0xff, down = 0xff;
                             for (std::size_t b = 0; b < 4; ++b, at += below) {
                                 right &= static_cast<unsigned>(at[0] & at[1] & at[2]);
                                 if (b < 3) down &= static_cast<unsigned>(at[0] & at[1] & at[2] & at[3]);
                             }
                             const bool is_whole =
                                 has(right, PositionField::kRight) && has(down, PositionField::kDown);
                             const bool on_one = has(right, kRightSame) && has(down, kDownSame);
                             whole[(row + 1) * below + x + 1] = static_cast<std::uint8_t>(
                                 (is_whole ? FieldPyramid::kWhole : 0) |
                                 (is_whole && on_one ? FieldPyramid::kWholeTriangle : 0));
                         }
                     }
                 });
    return whole;
}

}  // namespace

FieldPyramid::FieldPyramid(PositionField without_links) : field(std::move(without_links)) {
    shown = shown_window(field);
    link_neighbours(field, shown);
    patches = whole_patches(field, shown);
    levels.push_back(cell_level(*this));
    while (levels.back().size() > 1) levels.push_back(coarser(levels.back()));
}

Patch FieldPyramid::whole_patch(int column, int row) const {
    Patch patch;
    patch.measured = patch.supported = 0xffff;
    for (std::size_t b = 0; b < 4; ++b) {
        const std::size_t first = field.index(column - 1, row - 1 + static_cast<int>(b));
        for (std::size_t a = 0; a < 4; ++a) patch.nodes[a + 4 * b] = field.point(first + a);
    }
    return patch;
}

bool FieldPyramid::is_linked_cell(int column, int row) const {
    if (!field.contains(column, row) || !field.contains(column + 1, row + 1)) return false;
    constexpr std::uint8_t both = PositionField::kRight | PositionField::kDown;
    const std::size_t i = field.index(column, row), below = field.index(column, row + 1);
    return field.links[i] == both && (field.links[i + 1] & PositionField::kDown) &&
           (field.links[below] & PositionField::kRight);
}

bool FieldPyramid::may_show(const Vec3& point, int column, int row) const {
    const BoxQuad& quad = levels.front().at((column + 1) / 2, (row + 1) / 2);
    return quad.holding(point) >> ((column + 1) % 2 + 2 * ((row + 1) % 2)) & 1;
}

}  // namespace trilens
