// What the vector engine reads, and what it writes.
#pragma once

#include <cmath>
#include <span>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/visible.h"
#include "projector/scene/leaf_tree.h"
#include "projector/scene/prepared_data.h"
#include "projector/tiles/sample_tiles.h"

namespace trilens {

/// How leaves are drawn: by what is cheapest, or always in one way (to test each).
enum class LeafMode { kCheapest, kTriangles, kFacets, kRays };

/// What a vector's samples see, not yet placed.
struct alignas(64) VectorVisible {
    Id triangle[kLanes];  // index into the scene, or kNone
    float t_low[kLanes], t_high[kLanes];
};

inline void set_lane(VectorVisible& visible, std::size_t lane, const Visible& seen) {
    visible.triangle[lane] = seen.triangle;
    visible.t_low[lane] = seen.t_low;
    visible.t_high[lane] = seen.t_high;
}

/// Around a hit's t as closely as floats can.
inline Visible visible_of(const Hit& hit) {
    if (!hit.seen()) return {};
    const auto near = static_cast<float>(hit.t);
    return {hit.triangle, static_cast<double>(near) <= hit.t ? near : std::nextafter(near, -INFINITY),
            static_cast<double>(near) >= hit.t ? near : std::nextafter(near, INFINITY)};
}

struct KernelScene {
    const PreparedScene::Data* data = nullptr;
    const LeafTree* tree = nullptr;
    const RayMesh* mesh = nullptr;
    const SampleGrid* grid = nullptr;
    const SampleTiles* tiles = nullptr;
    // What is asked for: hits, or else what is visible, in one order or both.
    std::span<Hit> hits{};                      // by sample
    std::span<Visible> visible{};               // by sample
    std::span<VectorVisible> vector_visible{};  // by vector
};

/// Whether what is visible is asked for, not hits.
inline bool wants_visible(const KernelScene& scene) {
    return !scene.vector_visible.empty() || !scene.visible.empty();
}

}  // namespace trilens
