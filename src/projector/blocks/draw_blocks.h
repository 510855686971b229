// The exact engine in its plain form, block by block.
#pragma once

#include "base/raymesh/facet_samples.h"
#include "base/raymesh/sample_grid.h"
#include "projector/exact/facet_rays.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

/// What draw() does, in double throughout. `cull` false: every block tests every triangle; the same hits.
void draw_in_blocks(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                    const SampleGrid& grid, std::span<Hit> hits, bool cull);

/// The same for a few samples of one facet, at most kBlockSamples; hits[k] is that of samples[k].
void draw_block(const PreparedScene::Data& scene, const FacetRays& facet, const SampleGrid& grid,
                std::span<const Id> samples, std::span<Hit> hits);

}  // namespace trilens
