// Points in two halves that lie apart, by their coordinates alone.
#pragma once

#include <cstddef>
#include <span>

#include "base/math/vec.h"

namespace trilens {

/// A ball that holds points.
struct PointBall {
    Vec3 middle{0};
    double radius = 0;
};

/// The ball around the box of the points that `some` counts, at least one.
PointBall ball_around(std::span<const Vec3> points, std::span<const std::size_t> some);

/// Orders `some`, indices of finite points, more than `unit`, so that its first half comes before the second
/// along the longest side of their box, and returns the size of the first half: a multiple of `unit` >= 1 and
/// at least that, no more than half of the points where it can be. Which points come into which half is a
/// matter of their coordinates, not of their order.
std::size_t spatial_split(std::span<const Vec3> points, std::span<std::size_t> some, std::size_t unit = 1);

}  // namespace trilens
