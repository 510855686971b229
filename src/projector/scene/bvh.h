// A bounding volume hierarchy over boxes, by the binned surface area heuristic.
// Based on: Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007.
#pragma once

#include <functional>
#include <vector>

#include "base/math/box.h"
#include "base/util/ids.h"

namespace trilens {

/// A leaf holds the items order[first] .. order[first + count - 1]; an inner node (count 0) has the children
/// `first` and `first + 1`, which stand behind it.
struct BvhNode {
    Box box;
    Id first = 0;
    Id count = 0;
};

struct Bvh {
    std::vector<BvhNode> nodes;  // the root first; empty for no items
    std::vector<Id> order;       // every item once
};

/// The box of one item; called from many threads, finite and not empty.
using BoxOf = std::function<Box(Id item)>;

/// A tree over items 0 .. count - 1 whose nodes have no boxes yet (fit_boxes). The same boxes give the same
/// tree, for any number of threads: it is decided in single precision, which moves cuts but hides nothing.
Bvh build_bvh(std::size_t count, const BoxOf& box_of);

/// Gives every node the box of its items. `box_at`: of the item that stands at this place of the order.
void fit_boxes(Bvh& bvh, const BoxOf& box_at);

}  // namespace trilens
