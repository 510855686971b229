// A square of 2^n + 1 samples a side around a grid of heights: what quadtrees and wavelets need.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/image/height_grid.h"

namespace trilens {

/// Of loops over rows.
inline constexpr std::size_t kRowsPerTask = 16;

/// The heights at the square's lower corner, continued beyond the grid's last column and row by reflection in
/// the points there, so that slopes go on. Samples without a height count as 0 and are marked.
class HeightSquare {
  public:
    /// What is not finite or equals `no_data` is no height (`no_data` may be NaN: nothing equals it).
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

}  // namespace trilens
