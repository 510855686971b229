#include "base/raymesh/facets_around.h"

#include <algorithm>

namespace trilens {

std::vector<Id> FacetsAround::ring(const IdTriple& vertices) const {
    std::vector<Id> found;
    for (const Id v : vertices) {
        const std::span<const Id> here = of(v);
        found.insert(found.end(), here.begin(), here.end());
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count,
                           const std::function<Id(Id corner)>& vertex_of) {
    FacetsAround around;
    around.first.assign(vertex_count + 1, 0);
    const auto each = [&](const auto& body) {
        for (Id f = 0; f < facets.size(); ++f)
            for (const Id corner : facets[f])
                if (corner != kNone) body(vertex_of(corner), f);
    };
    each([&](Id vertex, Id) { ++around.first[vertex + 1]; });
    for (std::size_t v = 1; v < around.first.size(); ++v) around.first[v] += around.first[v - 1];
    around.facet.resize(around.first.back());
    std::vector<std::size_t> next(around.first.begin(), around.first.end() - 1);
    each([&](Id vertex, Id f) { around.facet[next[vertex]++] = f; });
    return around;
}

FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count) {
    return facets_around(facets, vertex_count, [](Id corner) { return corner; });
}

}  // namespace trilens
