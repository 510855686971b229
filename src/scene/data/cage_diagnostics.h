// Diagnostics of cages: what is legal but doubtful, and points far beyond the others.
#pragma once

#include <cstddef>
#include <optional>

#include "base/description/optic_description.h"

namespace trilens {

/// The surface between a far point and the others strays from every grid by more than the others' whole
/// size, so that each ray must be tried against much of it: a traced picture of a torus with one such point
/// takes eight times as long at 1e4, and a hundred times as long at 1e5.
inline constexpr double kFarthestPoint = 1e4;

/// The index of the farthest of the points that faces use, where it lies beyond kFarthestPoint times the
/// median distance. Distances are the largest of the three along the axes, from the median along each axis;
/// points that lie in that middle do not count. None where there is no such point.
std::optional<std::size_t> find_far_point(const Cage& cage);

}  // namespace trilens
