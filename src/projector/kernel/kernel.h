// The vector engine: what draw() does, 16 lanes at a time, with the same hits to the last bit.
#pragma once

#include <string>
#include <vector>

#include "projector/kernel/kernel_scene.h"

namespace trilens {

struct KernelState;

struct KernelOptions {
    LeafMode leaf_mode = LeafMode::kCheapest;
};

/// Samples that floats alone did not draw.
struct DrawCounts {
    std::size_t doubtful = 0;   // what they see was decided exactly, among few triangles
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
