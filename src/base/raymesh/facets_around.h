// Which facets meet at each vertex of a mesh.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/util/ids.h"

namespace trilens {

/// Lists of facets by vertex: those at vertex v are facet[first[v]] .. facet[first[v + 1] - 1], ascending.
struct FacetsAround {
    std::vector<std::size_t> first;  // number of vertices + 1 entries
    std::vector<Id> facet;

    std::span<const Id> of(Id vertex) const {
        return {facet.data() + first[vertex], first[vertex + 1] - first[vertex]};
    }
    /// The facets that share a vertex with one that has these three, itself among them; ascending, each once.
    std::vector<Id> ring(const IdTriple& vertices) const;
};

/// `vertex_of`: from a facet's corner to its vertex, below vertex_count. Facets of kNone are left out.
FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count,
                           const std::function<Id(Id corner)>& vertex_of);

/// The same where corners are the vertices.
FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count);

}  // namespace trilens
