// What the vector engine reads, and what it writes.
#pragma once

#include <span>

#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "projector/leaf_tree.h"
#include "projector/prepared_scene.h"
#include "projector/sample_tiles.h"

namespace trilens {

/// How leaves are drawn: by what is cheapest, or always in one way (to test each).
enum class LeafMode { kCheapest, kTriangles, kFacets, kRays };

/// The hits of a vector's samples, as a consumer in the same order wants them.
struct alignas(64) VectorHits {
    Id triangle[kLanes];  // index into the scene, or kNone
    float t[kLanes], u[kLanes], v[kLanes];
};

inline void set_lane(VectorHits& hits, std::size_t lane, const Hit& hit) {
    hits.triangle[lane] = hit.triangle;
    hits.t[lane] = static_cast<float>(hit.t);
    hits.u[lane] = static_cast<float>(hit.barycentric.x);
    hits.v[lane] = static_cast<float>(hit.barycentric.y);
}

struct KernelScene {
    const PreparedScene::Data* data = nullptr;
    const LeafTree* tree = nullptr;
    const RayMesh* mesh = nullptr;
    const SampleGrid* grid = nullptr;
    const SampleTiles* tiles = nullptr;
    // One of them, or both.
    std::span<Hit> hits;                // by sample
    std::span<VectorHits> vector_hits;  // by vector
};

}  // namespace trilens
