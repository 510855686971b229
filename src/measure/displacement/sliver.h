// Slivers: pieces of what is seen that are one pixel wide, where a point can be found along one axis only.
#pragma once

#include <optional>

#include "base/math/vec.h"
#include "measure/displacement/seen_field.h"

namespace trilens {

/// Where `field` (with its links) shows the point along the row or the column of linked pixels through the
/// point's own pixel, which must see the point's piece: the screen vector to there from the pixel, along one
/// axis (of the two answers the shorter). Between pixels positions are interpolated, beyond the line's ends
/// continued by less than a pixel. Across the line the piece has no slope, so a shift across it goes
/// unmeasured. Nothing where the pixel has no such neighbour, or the point lies off the line by more than
/// kOffLine times the step between its pixels: it is seen elsewhere, or the shift is mostly across.
std::optional<Vec2> find_along_sliver(const SeenField& field, const SeenPoint& wanted);

inline constexpr double kOffLine = 0.5;

}  // namespace trilens
