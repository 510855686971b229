// What whole grids and parts of them have in common.
#pragma once

#include <array>

#include "base/math/vec.h"

namespace trilens {

/// Along a side of a face.
inline constexpr int kMostSteps = 1024;

/// Whether a square is cut from its second corner to its fourth: the diagonal that is shorter in the world,
/// by at least a billionth of its square, so that rounding does not decide ties.
inline bool second_diagonal_is_shorter(const std::array<Vec3, 4>& corners) {
    const Vec3 first = corners[2] - corners[0], second = corners[3] - corners[1];
    return dot(second, second) < dot(first, first) * (1 - 1e-9);
}

}  // namespace trilens
