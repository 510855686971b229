// Whether the paths from two places have the same histories.
#pragma once

#include <vector>

#include "paths/trace/follow.h"

namespace trilens {

/// A path with so many times the least weight that is not matched is another history.
inline constexpr double kMuchLight = 8;

/// For each of `histories` its place in `segments`: the same steps, colours, media and end; empty where one
/// is missing.
std::vector<std::size_t> matched(const std::vector<PathSegment>& histories,
                                 const std::vector<PathSegment>& segments);

/// Whether no principal path and none that carries much light is left out of `match`.
bool covers(const std::vector<std::size_t>& match, const std::vector<PathSegment>& segments);

/// Whether the principal paths have the same histories: if not, no two lists with these among them are
/// matched() and covered both ways, whatever fainter paths there are.
bool same_principal(const std::vector<PathSegment>& a, const std::vector<PathSegment>& b);

}  // namespace trilens
