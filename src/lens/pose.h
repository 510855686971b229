// Rigid motions between the frames of a lens' surfaces: what optics programs write as tilts and decentres.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/math/vec.h"

namespace trilens {

/// A frame within another: its point p is turn * p + shift there.
struct LensPose {
    Mat3 turn{1};
    Vec3 shift{0};

    Vec3 point(const Vec3& p) const { return turn * p + shift; }
    Vec3 direction(const Vec3& d) const { return turn * d; }
    Vec3 local_point(const Vec3& p) const { return glm::transpose(turn) * (p - shift); }
    Vec3 local_direction(const Vec3& d) const { return glm::transpose(turn) * d; }
};

/// `inner` within `outer`'s frame.
inline LensPose operator*(const LensPose& outer, const LensPose& inner) {
    return {outer.turn * inner.turn, outer.point(inner.shift)};
}

inline LensPose inverse(const LensPose& pose) {
    return {glm::transpose(pose.turn), pose.local_point(Vec3(0))};
}

inline LensPose shifted(const Vec3& shift) {
    return {Mat3(1), shift};
}

inline LensPose along_axis(double z) {
    return shifted(Vec3(0, 0, z));
}

/// Turned about its x axis, then about the y axis that it has by then, then about its z axis; each from the
/// next axis to the one after that (right-handed). Multiples of 90 degrees are exact.
inline LensPose tilted(const Vec3& degrees) {
    LensPose pose;
    for (int axis = 0; axis < 3; ++axis) {
        const double quarters = degrees[axis] / 90, angle = degrees[axis] * std::numbers::pi / 180;
        const bool is_exact = quarters == std::round(quarters);
        const double c = is_exact ? std::round(std::cos(angle)) : std::cos(angle);
        const double s = is_exact ? std::round(std::sin(angle)) : std::sin(angle);
        const int next = (axis + 1) % 3, after = (axis + 2) % 3;
        Mat3 turn(1);
        turn[next][next] = turn[after][after] = c;
        turn[next][after] = s;
        turn[after][next] = -s;
        pose.turn = pose.turn * turn;
    }
    return pose;
}

/// Whether it moves nothing by more than rounding does, of lengths up to `size`.
inline bool is_identity(const LensPose& pose, double size = 1) {
    constexpr double kTurnRounding = 1e-12;
    double most = length(pose.shift) / (size > 0 ? size : 1);
    for (int k = 0; k < 3; ++k) most = std::max(most, length(pose.turn[k] - Mat3(1)[k]));
    return most < kTurnRounding;
}

}  // namespace trilens
