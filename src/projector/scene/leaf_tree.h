// The scene for the vector engine: triangles in leaves of 16, as floats around each leaf's centre, under
// nodes of 16 children.
#pragma once

#include <cstdint>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "projector/scene/bvh.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

inline constexpr std::size_t kLanes = 16;

/// Up to 16 triangles; lanes beyond `count` hold zeros. A corner's float differs from the double corner by
/// half a unit in the last place of the difference from `centre`, and its magnitude is at most `half`.
struct alignas(64) Leaf {
    float x[3][kLanes], y[3][kLanes], z[3][kLanes];  // sorted corners, from `centre`
    Id triangle[kLanes];                             // index into PreparedScene::Data
    double centre[3];                                // world frame
    float half[3];
    std::uint32_t count;
};

/// Boxes of up to 16 children, from the tree's centre, rounded outwards; empty lanes hold boxes that every
/// plane misses.
struct alignas(64) WideNode {
    float low[3][kLanes], high[3][kLanes];
    std::int32_t child[kLanes];  // a node, or the complement of a leaf
    std::uint32_t count;
};

struct LeafTree {
    std::vector<Leaf> leaves;
    std::vector<WideNode> nodes;
    std::int32_t root = 0;  // as a child
    Vec3 centre{0};         // world frame; of all boxes
    Vec3 half{0};           // every point is within it of the centre

    bool empty() const { return leaves.empty(); }
};

/// A tree over triangles 0 .. count - 1 by their boxes (called from many threads, finite and not empty),
/// whose leaves have no corners yet and name places of `order`, in which every triangle comes once. The same
/// boxes give the same tree.
LeafTree cut_leaf_tree(std::size_t count, const BoxOf& box_of, std::vector<Id>& order);

/// Gives the leaves their triangles' corners.
void fill_leaves(const PreparedScene::Data& data, LeafTree& tree);

}  // namespace trilens
