// Switches of the exact engine that tests and benchmarks turn; none changes a bit of what it draws.
#pragma once

#include <optional>

#include "projector/kernel/kernel.h"
#include "projector/scene/prepared_scene.h"
#include "projector/tiles/sample_tiles.h"

namespace trilens {

struct DrawOptions {
    bool vectors = true;  // false: one ray at a time, in double
    bool cull = true;     // false: every ray is offered every triangle, slowly
    KernelOptions kernel{};
    std::optional<TileParams> tiles{};  // none: tile_params() of the scene
};

void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits, const DrawOptions& options);

/// Of `options` the vector engine's.
void find_visible(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Visible> visible, const DrawOptions& options);

}  // namespace trilens
