#include "measure/pixel/regions.h"

#include <algorithm>
#include <vector>

#include "base/util/error.h"

namespace trilens {
namespace {

const std::vector<float>& alpha_of(const Image& image) {
    if (image.data_width < 0 || image.data_height < 0) throw InputError("", "", "the image has no size");
    const Channel* alpha = image.find("A");
    if (!alpha || alpha->is_id()) throw InputError("", "A", "is no channel of numbers of the image");
    if (alpha->floats().size() != image.pixels()) throw InputError("", "A", "has not one value per pixel");
    return alpha->floats();
}

/// Pixels not yet counted that are seen.
struct Cover {
    int width = 0, height = 0;
    std::vector<char> open;

    /// Takes the region of `start` out of what is open; returns how many pixels it has.
    std::size_t take_region(std::size_t start) {
        const auto columns = static_cast<std::size_t>(width);
        std::vector<std::size_t> found{start};
        open[start] = 0;
        for (std::size_t i = 0; i < found.size(); ++i) {
            const int x = static_cast<int>(found[i] % columns), y = static_cast<int>(found[i] / columns);
            for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny)
                for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx) {
                    const std::size_t next =
                        static_cast<std::size_t>(ny) * columns + static_cast<std::size_t>(nx);
                    if (!open[next]) continue;
                    open[next] = 0;
                    found.push_back(next);
                }
        }
        return found.size();
    }
};

}  // namespace

std::size_t count_regions(const Image& image, std::size_t least) {
    const std::vector<float>& alpha = alpha_of(image);
    Cover cover{image.data_width, image.data_height, std::vector<char>(alpha.size())};
    for (std::size_t i = 0; i < alpha.size(); ++i) cover.open[i] = alpha[i] > 0;
    std::size_t regions = 0;
    for (std::size_t i = 0; i < alpha.size(); ++i)
        if (cover.open[i]) regions += cover.take_region(i) >= least;
    return regions;
}

}  // namespace trilens
