// An axis-aligned box that grows.
#pragma once

#include <limits>

#include "base/math/vec.h"

namespace trilens {

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

}  // namespace trilens
