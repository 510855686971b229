// Sides of lenses of every form as heights over the plane across their axis.
#pragma once

#include "base/description/lens_side.h"
#include "base/math/vec.h"

namespace trilens {

/// z over x and y, with its derivatives.
struct SideSag {
    double z = 0;
    Vec2 slope{0};
    double xx = 0, xy = 0, yy = 0;

    /// The second derivative along a and b.
    double bend(const Vec2& a, const Vec2& b) const {
        return xx * a.x * b.x + xy * (a.x * b.y + a.y * b.x) + yy * a.y * b.y;
    }
};

/// NaN where the side has turned back.
SideSag sag_over(const LensSide& side, const Vec2& p);

/// What is left at the aperture to where the side turns back, as rim_room has it: 0 there; a lower bound,
/// which is close, for toric sides.
double side_room(const LensSide& side);

/// The largest |z|, and the largest lengths of its first, second and third derivatives along unit vectors.
struct SagBounds {
    double z = 0, first = 0, second = 0, third = 0;
};

/// Over the aperture of a side whose side_room is positive; upper bounds.
SagBounds sag_bounds(const LensSide& side);

/// What a lens of two sides at such a distance, with a round hole along its axis, cannot be; null: it can be
/// made. Where its sides come near each other between 128 places it is not seen.
const char* lens_fault(const LensSide& front, const LensSide& back, double thickness, double hole = 0);

}  // namespace trilens
