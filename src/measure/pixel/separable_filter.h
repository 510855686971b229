// Planes of numbers filtered along rows and columns.
#pragma once

#include <vector>

namespace trilens {

/// One number per pixel, rows from the top.
struct Plane {
    int width = 0, height = 0;
    std::vector<double> values;
};

/// An odd number of weights round a middle.
using Kernel = std::vector<double>;

/// out(x, y) = sum over i, j of along_rows[i] * along_columns[j] * plane(x + i - middle, y + j - middle).
/// Beyond the border the nearest value of the border counts. The same bits for any number of threads.
Plane filter_plane(const Plane& plane, const Kernel& along_rows, const Kernel& along_columns);

}  // namespace trilens
