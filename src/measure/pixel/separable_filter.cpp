#include "measure/pixel/separable_filter.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "measure/common/weighted_sums.h"

namespace trilens {
namespace {

constexpr std::size_t kRowsPerTask = 16;

Plane same_size(const Plane& plane) {
    return {plane.width, plane.height, std::vector<double>(plane.values.size(), 0.0)};
}

/// Calls body(y) for every row, on any thread.
void for_rows(const Plane& plane, const std::function<void(int y)>& body) {
    parallel_for(static_cast<std::size_t>(plane.height), kRowsPerTask,
                 [&](std::size_t first, std::size_t last) {
                     for (std::size_t y = first; y < last; ++y) body(static_cast<int>(y));
                 });
}

const double* row_of(const Plane& plane, int y) {
    return plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.width;
}
double* row_of(Plane& plane, int y) {
    return plane.values.data() + static_cast<std::ptrdiff_t>(y) * plane.width;
}

std::size_t columns_of(const Plane& plane) {
    return static_cast<std::size_t>(plane.width);
}

Plane filter_rows(const Plane& plane, const Kernel& kernel) {
    const int reach = static_cast<int>(kernel.size() / 2);
    Plane out = same_size(plane);
    for_rows(plane, [&](int y) {
        const double* row = row_of(plane, y);
        std::vector<double> padded(static_cast<std::size_t>(plane.width + 2 * reach));
        for (int x = -reach; x < plane.width + reach; ++x)
            padded[static_cast<std::size_t>(x + reach)] = row[std::clamp(x, 0, plane.width - 1)];
        std::vector<const double*> moved(kernel.size());
        for (std::size_t k = 0; k < moved.size(); ++k) moved[k] = padded.data() + k;
        weighted_sums(kernel, moved, {row_of(out, y), columns_of(out)});
    });
    return out;
}

Plane filter_columns(const Plane& plane, const Kernel& kernel) {
    const int reach = static_cast<int>(kernel.size() / 2);
    Plane out = same_size(plane);
    for_rows(plane, [&](int y) {
        std::vector<const double*> rows(kernel.size());
        for (int j = -reach; j <= reach; ++j)
            rows[static_cast<std::size_t>(j + reach)] = row_of(plane, std::clamp(y + j, 0, plane.height - 1));
        weighted_sums(kernel, rows, {row_of(out, y), columns_of(out)});
    });
    return out;
}

}  // namespace

Plane filter_plane(const Plane& plane, const Kernel& along_rows, const Kernel& along_columns) {
    TRILENS_CHECK(along_rows.size() % 2 == 1 && along_columns.size() % 2 == 1, "a kernel has a middle");
    return filter_columns(filter_rows(plane, along_rows), along_columns);
}

PictureWindow differing_window(const ColourPicture& one, const ColourPicture& other) {
    PictureWindow window;
    for (int y = 0; y < one.height; ++y) {
        const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(one.width);
        const auto is_same = [&](int x) {
            const std::size_t i = row + static_cast<std::size_t>(x);
            return one.r[i] == other.r[i] && one.g[i] == other.g[i] && one.b[i] == other.b[i] &&
                   is_number(one, i);
        };
        int first = 0, last = one.width;
        while (first < last && is_same(first)) ++first;
        if (first == last) continue;
        while (is_same(last - 1)) --last;
        window = {std::min(window.x0, first), std::min(window.y0, y), std::max(window.x1, last), y + 1};
    }
    return window;
}

CroppedPicture::CroppedPicture(const ColourPicture& whole, const PictureWindow& window)
    : width_(window.x1 - window.x0), height_(window.y1 - window.y0) {
    const std::array<std::span<const float>, 3> all = {whole.r, whole.g, whole.b};
    for (std::size_t c = 0; c < 3; ++c) {
        for (int y = window.y0; y < window.y1; ++y) {
            const auto row = all[c].begin() + static_cast<std::ptrdiff_t>(y) * whole.width;
            channels_[c].insert(channels_[c].end(), row + window.x0, row + window.x1);
        }
    }
}

}  // namespace trilens
