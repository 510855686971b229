// Which samples each facet of a RayMesh owns: every sample belongs to one facet at most.
#pragma once

#include <span>
#include <vector>

#include "base/util/ids.h"

namespace trilens {

/// Samples grouped by facet: those of facet f are sample[first[f]] .. sample[first[f + 1] - 1], ascending.
struct FacetSamples {
    std::vector<std::size_t> first;  // number of facets + 1 entries
    std::vector<Id> sample;          // indices into a SampleGrid

    std::span<const Id> of(std::size_t facet) const {
        return {sample.data() + first[facet], first[facet + 1] - first[facet]};
    }
};

/// Groups samples by owner. `owner`: per sample its facet, or kNone; every facet is below facet_count.
FacetSamples group_by_facet(std::span<const Id> owner, std::size_t facet_count);

}  // namespace trilens
