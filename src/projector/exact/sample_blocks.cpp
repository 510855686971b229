// Cuts a facet's samples into strips and blocks; samples ascend pixel by pixel in rows, so a strip is a
// range.
#include "projector/exact/sample_blocks.h"

#include <algorithm>

namespace trilens {
namespace {

/// The side of a block in pixels.
std::size_t pixels_along_block(const SampleGrid& grid) {
    return static_cast<std::size_t>(std::max(1, kBlockSide / grid.side));
}

}  // namespace

std::vector<Strip> make_strips(const FacetSamples& owned, const SampleGrid& grid) {
    const std::size_t row =
        static_cast<std::size_t>(grid.width()) * static_cast<std::size_t>(grid.samples_per_pixel());
    const std::size_t rows = pixels_along_block(grid);
    std::vector<Strip> strips;
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f) {
        std::size_t first = owned.first[f];
        while (first < owned.first[f + 1]) {
            const std::size_t end = (owned.sample[first] / row + rows) * row;
            const auto begin = owned.sample.begin();
            const auto stop = std::lower_bound(begin + static_cast<std::ptrdiff_t>(first),
                                               begin + static_cast<std::ptrdiff_t>(owned.first[f + 1]), end);
            const std::size_t last = static_cast<std::size_t>(stop - begin);
            strips.push_back({static_cast<Id>(f), first, last});
            first = last;
        }
    }
    return strips;
}

void for_each_block(std::span<const Id> strip, const SampleGrid& grid,
                    const std::function<void(std::span<const Id> block)>& body) {
    const std::size_t per_pixel = static_cast<std::size_t>(grid.samples_per_pixel());
    const std::size_t width = static_cast<std::size_t>(grid.width());

    std::vector<std::size_t> cell(strip.size());  // at first the column of pixels
    for (std::size_t s = 0; s < strip.size(); ++s) cell[s] = strip[s] / per_pixel % width;

    // Blocks start at the strip's leftmost pixel, not at multiples of eight: fewer of them are partly filled.
    const auto [left, right] = std::minmax_element(cell.begin(), cell.end());
    const std::size_t across = pixels_along_block(grid), start_column = *left;
    std::vector<std::size_t> start((*right - start_column) / across + 2, 0);
    for (std::size_t& c : cell) c = (c - start_column) / across;

    // Sort by counting; the samples of a cell keep their order.
    for (const std::size_t c : cell) ++start[c + 1];
    for (std::size_t c = 1; c < start.size(); ++c) start[c] += start[c - 1];
    std::vector<Id> sorted(strip.size());
    std::vector<std::size_t> next(start.begin(), start.end() - 1);
    for (std::size_t s = 0; s < strip.size(); ++s) sorted[next[cell[s]]++] = strip[s];

    // With more than 8 x 8 samples in a pixel, a cell is several blocks.
    for (std::size_t c = 0; c + 1 < start.size(); ++c) {
        for (std::size_t first = start[c]; first < start[c + 1]; first += kBlockSamples) {
            const std::size_t count = std::min(kBlockSamples, start[c + 1] - first);
            body(std::span<const Id>(sorted).subspan(first, count));
        }
    }
}

}  // namespace trilens
