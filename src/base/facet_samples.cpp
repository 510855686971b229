#include "base/facet_samples.h"

#include "base/check.h"

namespace trilens {

FacetSamples group_by_facet(std::span<const Id> owner, std::size_t facet_count) {
    FacetSamples result;
    result.first.assign(facet_count + 1, 0);
    for (const Id facet : owner) {
        if (facet == kNone) continue;
        TRILENS_CHECK(facet < facet_count, "an owner must be a facet of the mesh");
        ++result.first[facet + 1];
    }
    for (std::size_t f = 0; f < facet_count; ++f) result.first[f + 1] += result.first[f];

    result.sample.resize(result.first.back());
    std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
    for (std::size_t s = 0; s < owner.size(); ++s) {
        if (owner[s] != kNone) result.sample[next[owner[s]]++] = static_cast<Id>(s);
    }
    return result;
}

}  // namespace trilens
