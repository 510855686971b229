// A facet's samples in strips of the film's rows, and a strip's in blocks of at most 8 x 8 samples.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/facet_samples.h"
#include "base/raymesh/sample_grid.h"

namespace trilens {

inline constexpr std::size_t kBlockSamples = 64;
inline constexpr int kBlockSide = 8;

/// Samples of one facet in a few rows of pixels: FacetSamples::sample[first] .. sample[last - 1].
struct Strip {
    Id facet = 0;
    std::size_t first = 0, last = 0;
};

/// All owned samples, each in one strip; a strip is kBlockSide rows of samples high, or one row of pixels if
/// that is more.
std::vector<Strip> make_strips(const FacetSamples& owned, const SampleGrid& grid);

/// Calls body once for each block of a strip's samples (at most kBlockSamples, neighbours on the film). A
/// strip has at least one sample.
void for_each_block(std::span<const Id> strip, const SampleGrid& grid,
                    const std::function<void(std::span<const Id> block)>& body);

}  // namespace trilens
