// Bounding volume hierarchies over the triangles of a scene: a binary one by the surface area heuristic, and a
// wide one whose leaves fill vectors.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "base/math/box.h"
#include "base/math/vec.h"
#include "base/util/ids.h"
#include "base/util/parallel.h"
#include "projector/exact/exact_hit.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

// A bounding volume hierarchy over boxes, by the binned surface area heuristic.
// Based on: Wald, On fast Construction of SAH-based Bounding Volume Hierarchies, 2007.

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

// The scene for the vector engine: triangles in leaves of 16, as floats around each leaf's centre, under
// nodes of 16 children.

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

// A scene made ready for drawing: triangles in the order of the leaves of the vector engine's tree.

/// What is asked of a triangle that a sample sees, in one place of the memory. Its corners are sorted by
/// their coordinates, so that triangles with the same corners give the same bits whatever their winding:
/// coincident triangles tie exactly.
struct PreparedTriangle {
    std::array<Vec3, 3> corner;  // sorted
    // The index into the scene; above it, two bits each, which sorted corner is the scene's second and third.
    std::uint64_t name = 0;

    static constexpr int kSecondBit = 32, kThirdBit = 34;
    Id triangle() const { return static_cast<Id>(name); }
    std::size_t second() const { return name >> kSecondBit & 3; }
    std::size_t third() const { return name >> kThirdBit & 3; }
};

/// One entry per triangle, in leaf order.
struct PreparedScene::Data {
    std::vector<PreparedTriangle> triangles;
    std::vector<Id> named;  // indices into the scene, after one that is kNone
    std::vector<Id> ranks;  // as rank() gives them; none where they are the indices into the scene
    LeafTree leaves;        // over the arrays above, for the vector engine

    /// A tree over the arrays above for the scalar and the classic engine, made when it is first asked for.
    /// Thread-safe.
    const Bvh& bvh() const;

    std::size_t size() const { return triangles.size(); }
    /// The place of triangle i in the order of (object, primitive, index into the scene).
    Id rank(std::size_t i) const { return ranks.empty() ? named[i + 1] : ranks[i]; }
    /// The sorted corner k of triangle i, from `centre`.
    Vec3 corner(std::size_t k, std::size_t i, const Vec3& centre) const {
        return triangles[i].corner[k] - centre;
    }

  private:
    Lazy<Bvh> bvh_;
};

/// A line's hit of triangle `index` of the data, in the terms of the scene's own triangle.
inline Hit scene_hit(const PreparedScene::Data& data, Id index, const LineHit& hit) {
    const Vec2 b = hit.barycentric;
    const std::array<double, 3> sorted{std::max(0.0, 1 - b.x - b.y), b.x, b.y};
    const PreparedTriangle& triangle = data.triangles[index];
    return {triangle.triangle(), hit.t, {sorted[triangle.second()], sorted[triangle.third()]}};
}

}  // namespace trilens
