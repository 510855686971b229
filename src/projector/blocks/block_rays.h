// The rays of a block of samples: one linear family over local screen coordinates.
#pragma once

#include <array>
#include <span>

#include "base/raymesh/sample_grid.h"
#include "projector/exact/facet_rays.h"
#include "projector/exact/sample_blocks.h"
#include "trilinear/edge_conic.h"

namespace trilens {

/// Local coordinates u, v run over [-1, 1]^2 of the rectangle that the block's samples span; positions are
/// measured from the facet's centre.
struct BlockRays {
    Vec3 centre{0};  // world frame
    AffineRays rays;
    LineQuadratic line;
    // Sums of the absolute terms of origin, direction and weight over the block, in the 1-norm.
    double origin_size = 0, direction_size = 0, weight_size = 0;
    double weight_least = 0;  // a lower bound of the weight; may be negative
    std::size_t count = 0;
    std::array<SampleRay, kBlockSamples> sample{};  // what decides
};

/// `samples`: at least one, at most kBlockSamples.
BlockRays make_block_rays(const FacetRays& facet, const SampleGrid& grid, std::span<const Id> samples);

}  // namespace trilens
