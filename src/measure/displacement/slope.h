// Slopes of a seen field: how what is seen changes from pixel to pixel, and how many pixels a change takes.
#pragma once

#include <optional>

#include "base/math/vec.h"
#include "measure/displacement/seen_field.h"

namespace trilens {

/// The change of the seen point per pixel to the right and down, between linked neighbours: over both where
/// there are two. Nothing along an axis on which the pixel has none.
struct Slopes {
    std::optional<Vec3> right, down;
};

/// `field` with its links; the pixel must be in it.
Slopes slopes_at(const SeenField& field, int column, int row);

/// How many pixels it takes to change what is seen by `step`, to first order. With two slopes the part of the
/// step that leaves their plane counts as if along the longer one. With one slope only the part along it
/// counts: of what lies across, a piece one pixel wide says nothing. Infinite where the slopes are too short
/// or too nearly parallel for the step; nothing without slopes.
std::optional<double> pixels_for(const Slopes& slopes, const Vec3& step);

}  // namespace trilens
