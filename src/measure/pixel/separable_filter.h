// Separable filters of planes of numbers, over the windows in which two pictures differ.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "measure/pixel/flip.h"

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

/// Whether all three values of pixel i are finite.
inline bool is_number(const ColourPicture& picture, std::size_t i) {
    return std::isfinite(picture.r[i]) && std::isfinite(picture.g[i]) && std::isfinite(picture.b[i]);
}

/// Pixels x0 .. x1 - 1, y0 .. y1 - 1.
struct PictureWindow {
    int x0 = std::numeric_limits<int>::max(), y0 = x0, x1 = 0, y1 = 0;

    bool is_empty() const { return x0 >= x1; }
    bool contains(int x, int y) const { return x >= x0 && x < x1 && y >= y0 && y < y1; }
    /// By so many pixels to each side, as far as the picture reaches.
    PictureWindow grown(int by, const ColourPicture& inside) const {
        return {std::max(0, x0 - by), std::max(0, y0 - by), std::min(inside.width, x1 + by),
                std::min(inside.height, y1 + by)};
    }
};

/// The smallest window about all pixels in which two pictures of one size differ or are not finite.
PictureWindow differing_window(const ColourPicture& one, const ColourPicture& other);

/// A copy of a window of a picture.
class CroppedPicture {
  public:
    CroppedPicture(const ColourPicture& whole, const PictureWindow& window);
    ColourPicture picture() const { return {width_, height_, channels_[0], channels_[1], channels_[2]}; }

  private:
    int width_, height_;
    std::array<std::vector<float>, 3> channels_;
};

}  // namespace trilens
