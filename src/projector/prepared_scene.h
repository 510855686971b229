// A scene made ready for drawing: triangles in the order of the leaves of the vector engine's tree.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/lazy.h"
#include "projector/bvh.h"
#include "projector/first_hits.h"
#include "projector/leaf_tree.h"
#include "projector/projector.h"

namespace trilens {

/// One entry per triangle, in leaf order. A triangle's corners are sorted by their coordinates, so that
/// triangles with the same corners give the same bits whatever their winding: coincident triangles tie
/// exactly.
struct PreparedScene::Data {
    std::vector<std::array<Vec3, 3>> corners;  // sorted
    std::vector<std::array<std::uint8_t, 3>>
        was_corner;            // which corner of the scene's triangle a sorted one is
    std::vector<Id> triangle;  // index into the scene
    std::vector<Id> rank;      // its place in the order of (object, primitive, index)
    LeafTree leaves;           // over the arrays above, for the vector engine

    /// A tree over the arrays above for the other engines, made when it is first asked for. Thread-safe.
    const Bvh& bvh() const;

    std::size_t size() const { return triangle.size(); }
    /// The sorted corner k of triangle i, from `centre`.
    Vec3 corner(std::size_t k, std::size_t i, const Vec3& centre) const { return corners[i][k] - centre; }

  private:
    Lazy<Bvh> bvh_;
};

/// A line's hit of triangle `index` of the data, in the terms of the scene's own triangle.
inline Hit scene_hit(const PreparedScene::Data& data, Id index, const LineHit& hit) {
    const Vec2 b = hit.barycentric;
    const std::array<double, 3> sorted{std::max(0.0, 1 - b.x - b.y), b.x, b.y};
    std::array<double, 3> weight{};
    for (std::size_t k = 0; k < 3; ++k) weight[data.was_corner[index][k]] = sorted[k];
    return {data.triangle[index], hit.t, {weight[1], weight[2]}};
}

}  // namespace trilens
