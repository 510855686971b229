// A scene made ready for drawing: triangles in the order of the leaves of the vector engine's tree.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "base/util/parallel.h"
#include "projector/exact/exact_hit.h"
#include "projector/scene/bvh.h"
#include "projector/scene/leaf_tree.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

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
