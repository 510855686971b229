// The prior of a search: where the image of a point is expected, by the field's slopes, and along slivers one
// pixel wide.
#pragma once

#include <array>
#include <optional>

#include "base/math/vec.h"
#include "measure/field/patch.h"
#include "measure/field/position_field.h"

namespace trilens {

/// Hits outside the cell are penalised, so the neighbouring cell wins ties; so are hits on another triangle,
/// which are less exact. Never less than the distance.
inline constexpr double kOvershootPenalty = 2, kOtherPrimitivePenalty = 0.25;
inline constexpr double kMostPenalty = 1;  // more than both together
static_assert(kOvershootPenalty * kOvershoot + kOtherPrimitivePenalty < kMostPenalty);

/// Pixels. Two images of one point this near to each other are the two sides of one fold.
inline constexpr double kSurelyNearest = 0.25;

/// The point's object and optic, whichever its triangle.
inline SurfaceId piece_of(const FieldSample& point) {
    return {point.object, point.optic, std::nullopt};
}

/// Which way from its pixel the point lies, by the slopes of the field (with its links) there: the signs of
/// its offset.
std::array<int, 2> likely_side(const PositionField& field, const FieldSample& wanted);

/// How far the displaced image of the point may lie, pixels, by the slopes of both images at the pixel. On
/// the way to it the seen point moves from what the reference shows at the pixel to the wanted one; near a
/// fold it moves up to twice as far as the slopes say, round a corner between two walls as far again.
/// Infinite where the reference shows something else all round the pixel.
double farthest_place(const PositionField& field, const PositionField& test, const FieldSample& wanted);

/// The change of the seen point per pixel to the right and down, between linked neighbours: over both where
/// there are two. Nothing along an axis on which the pixel has none.
struct Slopes {
    std::optional<Vec3> right, down;
};

/// `field` with its links; the pixel must be in it.
Slopes slopes_at(const PositionField& field, int column, int row);

/// How many pixels it takes to change what is seen by `step`, to first order. With two slopes the part of the
/// step that leaves their plane counts as if along the longer one. With one slope only the part along it
/// counts: of what lies across, a piece one pixel wide says nothing. Infinite where the slopes are too short
/// or too nearly parallel for the step; nothing without slopes.
std::optional<double> pixels_for(const Slopes& slopes, const Vec3& step);

/// Where `field` (with its links) shows the point along the row or the column of linked pixels through the
/// point's own pixel, which must see the point's piece: the screen vector to there from the pixel, along one
/// axis (of the two answers the shorter). Between pixels positions are interpolated, beyond the line's ends
/// continued by less than a pixel. Across the line the piece has no slope, so a shift across it goes
/// unmeasured. Nothing where the pixel has no such neighbour, or the point lies off the line by more than
/// kOffLine times the step between its pixels: it is seen elsewhere, or the shift is mostly across.
std::optional<Vec2> find_along_sliver(const PositionField& field, const FieldSample& wanted);

inline constexpr double kOffLine = 0.5;

}  // namespace trilens
