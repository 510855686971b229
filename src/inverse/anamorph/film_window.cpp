// The largest rectangle of a given aspect inside a mask: summed-area table (Crow 1984) and bisection over the
// size.
#include <algorithm>
#include <cmath>

#include "inverse/anamorph/anamorph.h"

namespace trilens {
namespace {

/// Sums over rectangles of cells.
class AreaTable {
  public:
    AreaTable(const std::vector<unsigned char>& cells, int columns, int rows)
        : stride_(static_cast<std::size_t>(columns) + 1),
          sums_(stride_ * (static_cast<std::size_t>(rows) + 1), 0) {
        for (int y = 0; y < rows; ++y)
            for (int x = 0; x < columns; ++x)
                sums_[at(x + 1, y + 1)] =
                    sums_[at(x, y + 1)] + sums_[at(x + 1, y)] - sums_[at(x, y)] +
                    cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                          static_cast<std::size_t>(x)];
    }
    long sum(int x, int y, int wide, int high) const {
        return sums_[at(x + wide, y + high)] - sums_[at(x, y + high)] - sums_[at(x + wide, y)] +
               sums_[at(x, y)];
    }

  private:
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x);
    }
    std::size_t stride_;
    std::vector<long> sums_;
};

}  // namespace

std::optional<PictureWindow> largest_window(const std::vector<unsigned char>& covered, int columns, int rows,
                                            const Vec2& film, double aspect) {
    const AreaTable table(covered, columns, rows);
    const Vec2 cell = film / Vec2(columns, rows);
    Vec2 middle(0);
    double count = 0;
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            if (covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                        static_cast<std::size_t>(x)])
                middle += Vec2(x + 0.5, y + 0.5), ++count;
    if (count == 0) return std::nullopt;
    middle /= count;

    // Of the places that hold a window of so many cells the one nearest to the middle of what is covered.
    const auto place = [&](int wide) -> std::optional<std::array<int, 4>> {
        const int high = std::max(1, static_cast<int>(std::ceil(wide * cell.x / aspect / cell.y - 1e-9)));
        std::optional<std::array<int, 4>> best;
        double nearest = 0;
        for (int y = 0; y + high <= rows; ++y)
            for (int x = 0; x + wide <= columns; ++x) {
                if (table.sum(x, y, wide, high) != 1L * wide * high) continue;
                const double off = length(Vec2(x + 0.5 * wide, y + 0.5 * high) - middle);
                if (!best || off < nearest) best = {x, y, wide, high}, nearest = off;
            }
        return best;
    };
    int least = 0, most = columns;
    std::optional<std::array<int, 4>> best;
    while (least < most) {
        const int wide = (least + most + 1) / 2;
        const auto found = place(wide);
        if (found)
            best = found, least = wide;
        else
            most = wide - 1;
    }
    if (!best) return std::nullopt;
    const auto& [x, y, wide, high] = *best;
    const double width = wide * cell.x, height = width / aspect;
    const Vec2 corner(x * cell.x, (y + 0.5 * high) * cell.y - 0.5 * height);
    return PictureWindow{corner.x, corner.y, corner.x + width, corner.y + height};
}

}  // namespace trilens
