// Where the image of a seen point is to be expected, and how good a place is.
#pragma once

#include <array>
#include <optional>

#include "measure/displacement/patch.h"
#include "measure/displacement/seen_field.h"

namespace trilens {

/// A hit outside its cell is the cell next door's business, a hit on another triangle is less exact: both
/// count as farther away, so that the better answer wins where two say nearly the same. Never less than the
/// distance.
inline constexpr double kOvershootPenalty = 2, kOtherPrimitivePenalty = 0.25;
inline constexpr double kMostPenalty = 1;  // more than both together
static_assert(kOvershootPenalty * kOvershoot + kOtherPrimitivePenalty < kMostPenalty);

/// Pixels. Two images of one point this near to each other are the two sides of one fold.
inline constexpr double kSurelyNearest = 0.25;

/// The point's object and optic, whichever its triangle.
inline Piece piece_of(const SeenPoint& point) {
    return {point.object, point.optic, std::nullopt};
}

/// Which way from its pixel the point lies, by the slopes of the field (with its links) there: the signs of
/// its offset.
std::array<int, 2> likely_side(const SeenField& field, const SeenPoint& wanted);

/// How far the displaced image of the point may lie, pixels, by the slopes of both images at the pixel. On
/// the way to it the seen point moves from what the reference shows at the pixel to the wanted one; near a
/// fold it moves up to twice as far as the slopes say, round a corner between two walls as far again.
/// Infinite where the reference shows something else all round the pixel.
double farthest_place(const SeenField& field, const SeenField& test, const SeenPoint& wanted);

}  // namespace trilens
