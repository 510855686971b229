#include "measure/displacement/outlier_rejection.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr int kWindowReach = 3;  // of the 7 x 7 window

/// Shifts below this are never another image: the bound of the test at a median of zero.
constexpr double kLeast = kOtherImage * 0.5;

/// Whether the shift exceeds the bound by the window's median: by more than half of the window's shifts.
bool is_jump(const Displacement& displacement, std::span<const double> size, int width, std::size_t pixel) {
    const int height = static_cast<int>(size.size()) / width;
    const int column = static_cast<int>(pixel) % width, row = static_cast<int>(pixel) / width;
    std::size_t around = 0, small = 0;
    for (int y = std::max(0, row - kWindowReach); y <= std::min(height - 1, row + kWindowReach); ++y) {
        for (int x = std::max(0, column - kWindowReach); x <= std::min(width - 1, column + kWindowReach);
             ++x) {
            const std::size_t i =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
            const bool is_found = i != pixel && displacement.state[i] == Shift::kFound;
            around += is_found;
            small += is_found && size[pixel] > kOtherImage * (size[i] + 0.5);
        }
    }
    return around >= kFewestNeighbours && small > around / 2;
}

}  // namespace

void drop_other_images(Displacement& displacement, int width) {
    std::vector<double> size(displacement.state.size());
    parallel_for(size.size(), 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            if (displacement.state[i] == Shift::kFound)
                size[i] = std::hypot(displacement.shift_x[i], displacement.shift_y[i]);
    });

    // All are judged by the field as it was found, so the outcome does not depend on an order.
    std::vector<std::uint8_t> jump(size.size(), 0);
    parallel_for(size.size(), 4096, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            jump[i] = displacement.state[i] == Shift::kFound && size[i] > kLeast &&
                      is_jump(displacement, size, width, i);
    });
    for (std::size_t i = 0; i < size.size(); ++i) {
        if (!jump[i]) continue;
        displacement.state[i] = Shift::kLost;
        displacement.shift_x[i] = displacement.shift_y[i] = 0;
    }
}

}  // namespace trilens
