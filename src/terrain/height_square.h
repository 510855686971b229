// A square of 2^n + 1 samples a side around a grid of heights: what quadtrees and wavelets need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/image/height_grid.h"
#include "base/math/vec.h"

namespace trilens {

/// Of loops over rows.
inline constexpr std::size_t kRowsPerTask = 16;

/// Where the square's samples lie in the terrain's own frame.
struct SampleSpacing {
    Vec2 first{0}, step{1};  // x and z of sample (0, 0); of a step right and down
    double height = 1;       // y of a value of 1
};

/// The heights at the square's lower corner, continued beyond the grid's last column and row by reflection in
/// the points there, so that slopes go on. Samples without a height count as 0 and are marked.
class HeightSquare {
  public:
    /// What is not finite or stands for `no_data` is no height (`no_data` may be NaN: nothing does).
    HeightSquare(const HeightGrid& heights, double no_data);

    int levels() const { return levels_; }  // n
    int side() const { return side_; }      // 2^n + 1
    int last_column() const { return columns_ - 1; }
    int last_row() const { return rows_ - 1; }
    std::size_t missing() const { return missing_; }  // samples without a height

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(side_) + static_cast<std::size_t>(x);
    }
    double at(int x, int y) const { return values_[index(x, y)]; }
    bool is_inside(int x, int y) const { return x < columns_ && y < rows_; }
    /// Whether the sample is of the grid and has no height.
    bool is_missing(int x, int y) const {
        return missing_ > 0 && is_inside(x, y) && is_missing_[index(x, y)] != 0;
    }
    /// Whether a missing sample is this one or one of the eight around it.
    bool touches_missing(int x, int y) const;

  private:
    int columns_, rows_, levels_ = 0, side_ = 2;
    std::size_t missing_ = 0;
    std::vector<float> values_;
    std::vector<std::uint8_t> is_missing_;  // empty where none is
};

/// The triangulation's rule, of which samples are halves: the one at (x, y), at multiples of `half` of which
/// at least one is odd, is the middle of a side from (x - dx, y - dy) to (x + dx, y + dy). The diagonals of
/// squares go through the middle of the square around them.
struct HalvedSide {
    int dx = 0, dy = 0;
};
HalvedSide halved_side(int x, int y, int half);

/// Whether the diagonal of the square around (x, y), `half` to each side, falls to the right; else it rises.
bool diagonal_falls(int x, int y, int half);

/// The height there less the mean of its side's ends: the coefficient of its hat among those of the bisected
/// triangles.
double bisection_detail(const HeightSquare& heights, int x, int y, int half);

}  // namespace trilens
