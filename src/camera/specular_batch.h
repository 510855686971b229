// Many points of one query: what they have in common is searched once.
#pragma once

#include <span>
#include <vector>

#include "camera/specular_cells.h"
#include "camera/specular_search.h"

namespace trilens {

/// SpecularSearcher::find_each, for a surface with bounds and a query with own normals.
std::vector<SpecularSearch> search_each(const Surface& surface, const SurfaceCells& cells,
                                        const SpecularQuery& query, std::span<const Vec3> points,
                                        const SearchLimits& limits);

}  // namespace trilens
