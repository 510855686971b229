// Visibility of many samples without their records: which triangles they see by which histories, as keys.
// After: Burns and Hunt, The Visibility Buffer: A Cache-Friendly Approach to Deferred Shading, JCGT 2013.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "paths/nested/nested_optics.h"
#include "render/engines/rim_samples.h"
#include "render/frame/fragment_key.h"
#include "render/frame/frame.h"
#include "render/world/world.h"

namespace trilens {

/// What a facet viewer of a projecting engine is made of.
struct FragmentKeysParams {
    const World& world;
    const Frame& frame;
    const std::vector<SampleGrid>& windows;                    // where each optic may be seen
    std::vector<PathBuilder>& paths;                           // per optic
    const std::vector<std::unique_ptr<NestedOptics>>& nested;  // per optic; null: it has none
    const OpticRims& rims;
};

/// The key of every sample of the grid: fragment_key() of the view that the exact projector's viewer has of
/// it, or kAlone where bounds do not decide it, or its paths are traced or lead over nested optics. Works out
/// the facets that are seen and were not before. `grid`: in lattice order, all its samples.
void find_fragment_keys(const FragmentKeysParams& params, const SampleGrid& grid,
                        std::span<FragmentKey> keys);

}  // namespace trilens
