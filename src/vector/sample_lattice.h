// A film's samples as rows and columns.
#pragma once

#include <cmath>

#include "base/raymesh/sample_grid.h"

namespace trilens {

struct SampleLattice {
    const SampleGrid& grid;

    int columns() const { return grid.width() * grid.side; }
    int rows() const { return grid.height() * grid.side; }
    bool holds(int column, int row) const {
        return column >= 0 && row >= 0 && column < columns() && row < rows();
    }
    std::size_t sample(int column, int row) const {
        const int s = grid.side;
        return grid.first_sample(grid.x0 + column / s, grid.y0 + row / s) +
               static_cast<std::size_t>(row % s * s + column % s);
    }
    int column(std::size_t sample) const {
        return static_cast<int>(std::lround((grid.position(sample).x - grid.x0) * grid.side - 0.5));
    }
    int row(std::size_t sample) const {
        return static_cast<int>(std::lround((grid.position(sample).y - grid.y0) * grid.side - 0.5));
    }
};

}  // namespace trilens
