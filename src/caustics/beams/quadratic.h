// Quadratic interpolation over a triangle (isoparametric six-node element), and how far it may be off.
#pragma once

#include <array>

#include "base/math/vec.h"

namespace trilens {

/// Quadratic Lagrange weights of the corners and of the middles across from them.
inline std::array<double, 6> quadratic_weights(const Vec3& w) {
    return {w.x * (2 * w.x - 1), w.y * (2 * w.y - 1), w.z * (2 * w.z - 1),
            4 * w.y * w.z,       4 * w.z * w.x,       4 * w.x * w.y};
}

/// Twice the signed area, per share of the triangle there, on which a quadratic through places puts it: its
/// Jacobian.
inline double quadratic_spread(const std::array<Vec2, 6>& at, const Vec3& w) {
    const Vec2 by_x = (4 * w.x - 1) * at[0] + 4.0 * (w.z * at[4] + w.y * at[5]),
               by_y = (4 * w.y - 1) * at[1] + 4.0 * (w.z * at[3] + w.x * at[5]),
               by_z = (4 * w.z - 1) * at[2] + 4.0 * (w.y * at[3] + w.x * at[4]);
    return cross(by_y - by_x, by_z - by_x);
}

/// On a plane a curved beam may be off by the first share of the tolerance, or by the second times how many
/// times brighter the brightest path is; one that stands for many by the latter.
inline constexpr double kMostOff = 0.25, kFaintOff = 0.05;
/// A beam whose sides are straight to so many times that needs no look at its quadratic.
inline constexpr double kNearlyStraight = 6;

/// Beams whose light on a plane is below this share of the light's mean over the scene are not looked at
/// closely.
inline constexpr double kFaintShare = 0.05;

}  // namespace trilens
