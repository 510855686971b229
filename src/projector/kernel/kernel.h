// The vector engine: what draw() does, 16 lanes at a time, with the same hits to the last bit.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "projector/scene/bvh.h"
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

/// Visible::triangle of a pixel whose samples may see several.
inline constexpr Id kSeveral = kNone - 1;

/// A triangle (index into the scene) that samples of a pixel may see.
struct PixelTriangle {
    Id pixel = kNone, triangle = kNone;
};

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
    // The tiles' lanes are pixels, and `visible` is by pixel: what all its samples surely see, or kSeveral.
    bool pixels = false;
    std::vector<PixelTriangle>* open =
        nullptr;  // gets all that pixels with kSeveral may see; null: not asked for
};

/// Whether what is visible is asked for, not hits.
inline bool wants_visible(const KernelScene& scene) {
    return !scene.vector_visible.empty() || !scene.visible.empty();
}

struct KernelState;

struct KernelOptions {
    LeafMode leaf_mode = LeafMode::kCheapest;
};

/// Samples that floats alone did not draw.
struct DrawCounts {
    std::size_t ambiguous = 0;  // what they see was decided exactly, among few triangles
    std::size_t unbounded = 0;  // the vector engine has no bounds for them: the scalar engine drew them
};

/// Draws all batches, in parallel, those that the vector engine cannot bound by the scalar one.
DrawCounts draw_tiles(const KernelScene& scene, const KernelOptions& options);

/// Draws one batch of tiles. `state` is the thread's own; its contents do not matter. Returns the tiles that
/// it cannot bound (bit j: the batch's tile j), whose hits are not written.
std::uint32_t draw_batch(const KernelScene& scene, std::size_t batch, const KernelOptions& options,
                         KernelState& state);

/// Draws one mixed group. Returns the vectors that it cannot bound (bit v: the group's vector v), whose hits
/// are not written.
std::uint32_t draw_mixed(const KernelScene& scene, std::size_t group, KernelState& state);

/// The instruction sets that the engine is built for and this machine has, best first, as `--isa` names them;
/// only the one that use_instruction_set chose while it holds.
std::vector<std::string> kernel_instruction_sets();

/// Restricts the engine to one of them; empty: the best. For the whole process. Returns false for a name that
/// is none of them.
bool use_instruction_set(const std::string& name);

}  // namespace trilens
