#include "base/raymesh/sample_grid.h"

#include "base/util/check.h"

namespace trilens {
namespace {

/// Calls body(facet, begin, end) for each run of samples side by side that have one owner.
template <typename Body>
void for_each_run(std::span<const Id> owner, const Body& body) {
    for (std::size_t begin = 0; begin < owner.size();) {
        std::size_t end = begin + 1;
        while (end < owner.size() && owner[end] == owner[begin]) ++end;
        if (owner[begin] != kNone) body(owner[begin], begin, end);
        begin = end;
    }
}

}  // namespace

FacetSamples group_by_facet(std::span<const Id> owner, std::size_t facet_count) {
    FacetSamples result;
    result.first.assign(facet_count + 1, 0);
    for_each_run(owner, [&](Id facet, std::size_t begin, std::size_t end) {
        TRILENS_CHECK(facet < facet_count, "an owner must be a facet of the mesh");
        result.first[facet + 1] += end - begin;
    });
    for (std::size_t f = 0; f < facet_count; ++f) result.first[f + 1] += result.first[f];

    result.sample.resize(result.first.back());
    std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
    for_each_run(owner, [&](Id facet, std::size_t begin, std::size_t end) {
        Id* to = result.sample.data() + next[facet];
        for (std::size_t s = begin; s < end; ++s) *to++ = static_cast<Id>(s);
        next[facet] += end - begin;
    });
    return result;
}

}  // namespace trilens
