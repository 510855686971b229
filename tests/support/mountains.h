// A range of mountains as heights: sums of ridges of halved sizes, the same on every machine to the last
// bits.
#pragma once

#include <cmath>

#include "base/image/height_grid.h"

namespace trilens_test {

/// 0 .. about 1; rows and columns of any number over the unit square.
inline double mountain_height(double u, double v) {
    double height = 0, size = 0.5, turns = 3;
    for (int octave = 0; octave < 6; ++octave) {
        const double c = std::cos(1.1 * octave), s = std::sin(1.1 * octave);
        const double x = turns * (c * u - s * v) + octave, y = turns * (s * u + c * v) - octave;
        height += size * (1 - std::fabs(std::sin(x + std::sin(y)))) * (1 - 0.4 * std::sin(y) * std::sin(y));
        size *= 0.45;
        turns *= 2.1;
    }
    return height;
}

inline trilens::HeightGrid mountains(int columns, int rows) {
    trilens::HeightGrid heights{columns, rows, 1, {}};
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            heights.values.push_back(
                static_cast<float>(mountain_height(x / (columns - 1.0), y / (rows - 1.0))));
    return heights;
}

}  // namespace trilens_test
