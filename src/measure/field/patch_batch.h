// Several patches inverted side by side, one in each lane of a vector.
#pragma once

#include <cstddef>
#include <cstdint>

#include "measure/field/patch.h"

namespace trilens {

inline constexpr std::size_t kPatchLanes = 8;

/// Questions of invert_patch, and their answers. Lanes do not see each other: an answer has the same bits in
/// any lane, with any neighbours, and with any instruction set.
struct PatchBatch {
    struct Lane {
        double lane[kPatchLanes] = {};
    };

    alignas(64) Lane nodes[16][3];     // x, y, z, relative to the point that is looked for
    alignas(64) Lane start[2];         // u, v
    alignas(64) Lane size;             // the point's distance from the origin
    alignas(64) Lane extrapolated[4];  // 1 where that corner of the cell is mere extrapolation, else 0
    std::size_t count = 0;             // lanes 0 .. count - 1 are asked

    alignas(64) Lane u, v, overshoot;  // PatchHit, of the lanes that have one
    std::uint32_t hits = 0;            // bit i: lane i has one

    /// Asks where the patch shows the point. `supported` as Patch has it.
    void ask(std::size_t lane, const Vec3& point, const Vec2& from, std::uint16_t supported);
    void set_node(std::size_t lane, std::size_t node, const Vec3& relative) {
        for (int k = 0; k < 3; ++k) nodes[node][k].lane[lane] = relative[k];
    }
    bool has_hit(std::size_t lane) const { return hits >> lane & 1; }
};

/// Fills in the answers.
void invert_patches(PatchBatch& batch);

}  // namespace trilens
