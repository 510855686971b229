// A bounding volume hierarchy over boxes, by the binned surface area heuristic.
// Based on: Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "base/ids.h"
#include "base/vec.h"

namespace trilens {

/// An axis-aligned box; empty where lo > hi.
struct Box {
    Vec3 lo{std::numeric_limits<double>::infinity()};
    Vec3 hi{-std::numeric_limits<double>::infinity()};

    void include(const Vec3& point) {
        lo = glm::min(lo, point);
        hi = glm::max(hi, point);
    }
    void include(const Box& other) {
        lo = glm::min(lo, other.lo);
        hi = glm::max(hi, other.hi);
    }
};

/// A leaf holds the items order[first] .. order[first + count - 1]; an inner node (count 0) has the children
/// `first` and `first + 1`.
struct BvhNode {
    Box box;
    Id first = 0;
    Id count = 0;
};

struct Bvh {
    std::vector<BvhNode> nodes;  // the root first; empty for no items
    std::vector<Id> order;       // every item once
};

/// The same boxes give the same tree. Boxes are finite and not empty.
Bvh build_bvh(std::span<const Box> boxes);

}  // namespace trilens
