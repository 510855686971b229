// A bounding volume hierarchy over boxes, by the binned surface area heuristic.
// Based on: Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007.
#pragma once

#include <span>
#include <vector>

#include "base/box.h"
#include "base/ids.h"

namespace trilens {

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
