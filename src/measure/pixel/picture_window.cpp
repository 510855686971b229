#include "measure/pixel/picture_window.h"

#include <span>

namespace trilens {

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
