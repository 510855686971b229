// Axis-aligned boxes, and points split in two halves that lie apart.
#pragma once

#include <cstddef>
#include <limits>
#include <span>

#include "base/math/vec.h"

namespace trilens {

// An axis-aligned box that grows.

/// World frame; empty until something is included, and then low <= high.
struct Box {
    Vec3 low{std::numeric_limits<double>::infinity()};
    Vec3 high{-std::numeric_limits<double>::infinity()};

    bool empty() const { return !(low.x <= high.x && low.y <= high.y && low.z <= high.z); }
    void include(const Vec3& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    void include(const Box& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
    bool holds(const Vec3& point) const {
        return glm::all(glm::lessThanEqual(low, point)) && glm::all(glm::lessThanEqual(point, high));
    }
    /// Lengths of the sides; zero for an empty box.
    Vec3 size() const { return glm::max(high - low, Vec3(0)); }
    /// Half the area of its surface; zero for an empty box.
    double half_area() const {
        const Vec3 side = size();
        return side.x * side.y + side.y * side.z + side.z * side.x;
    }
};

// Points in two halves that lie apart, by their coordinates alone.

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
