// The rays of a block of samples: one linear family over local screen coordinates, around a local origin.
#pragma once

#include <array>
#include <span>

#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "projector/sample_blocks.h"
#include "trilinear/edge_conic.h"

namespace trilens {

/// Local coordinates u, v run over [-1, 1]^2 of the rectangle that the block's samples span; positions are
/// measured from `centre`, the origin of one of the block's rays, so that scenes far from the world's origin
/// lose nothing.
struct BlockRays {
    Vec3 centre{0};  // world frame
    AffineRays rays;
    LineQuadratic line;
    double origin_size = 0, direction_size = 0, weight_size = 0;  // bounds over the block, in the 1-norm
    double weight_least = 0;  // a lower bound of the weight; may be negative
    std::size_t count = 0;
    std::array<double, kBlockSamples> u{}, v{};
};

/// One facet and its weights on the screen.
struct FacetOnScreen {
    const RayMesh& mesh;
    std::size_t facet;
    FacetWeights weights;
};

/// `samples`: at least one, at most kBlockSamples.
BlockRays make_block_rays(const FacetOnScreen& facet, const SampleGrid& grid, std::span<const Id> samples);

}  // namespace trilens
