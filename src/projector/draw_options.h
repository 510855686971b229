// Switches of the exact engine that tests and benchmarks turn.
#pragma once

#include "projector/projector.h"

namespace trilens {

struct DrawOptions {
    bool cull = true;  // false: every block tests every triangle; the same hits, slowly
};

void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits, const DrawOptions& options);

}  // namespace trilens
