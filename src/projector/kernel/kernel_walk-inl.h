// The walk: a group of tiles goes down the tree together, nearest nodes first, with one beam around all.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WALK_INL_H
#undef TRILENS_KERNEL_WALK_INL_H
#else
#define TRILENS_KERNEL_WALK_INL_H
#endif

#include <algorithm>
#include <bit>

#include "projector/kernel/kernel_group_beam-inl.h"
#include "projector/kernel/kernel_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// A node's children that wait, and the least t of each.
struct Children {
    std::uint32_t lanes;
    Floats nearest;
};

/// Those that no plane of the beam cuts off, and that are no farther than `farthest`.
HWY_INLINE Children reached_children(const GroupBeam& beam, const WideNode& node, float farthest) {
    Mask missed = mask_of(0);
    for (int p = 0; p < beam.planes; ++p) {
        const float* n = beam.plane[p];
        const Floats height =
            multiply_add(set(n[0]), load(n[0] > 0 ? node.high[0] : node.low[0]),
                         multiply_add(set(n[1]), load(n[1] > 0 ? node.high[1] : node.low[1]),
                                      set(n[2]) * load(n[2] > 0 ? node.high[2] : node.low[2])));
        missed = missed | (height < set(beam.offset[p]));
    }
    const float* n = beam.axis;
    const Floats ahead = multiply_add(set(n[0]), load(n[0] > 0 ? node.low[0] : node.high[0]),
                                      multiply_add(set(n[1]), load(n[1] > 0 ? node.low[1] : node.high[1]),
                                                   set(n[2]) * load(n[2] > 0 ? node.low[2] : node.high[2])));
    const Floats t = (ahead - set(beam.start)) * set(beam.speed_inverse);
    // What is not a number is not ordered.
    const Floats nearest = choose(t > set(-kNever), t, set(-kNever));
    missed = missed | (nearest > set(farthest));
    return {first_lanes(node.count) & ~bits(missed), nearest};
}

/// Of an untouched tile, the group's k-th: all its vectors see the same, or nothing.
HWY_INLINE void spread_farthest(std::uint32_t k, KernelState& state) {
    const std::uint32_t j = state.first_lane + k;
    const float high = state.covered >> j & 1 ? state.whole[j].farthest : kNever;
    if (state.beams_made) {
        for (std::uint32_t i = state.tile_vectors[k]; i < state.tile_vectors[k + 1]; ++i)
            state.beams[i / kLanes].farthest[i % kLanes] = high;
    }
    state.farthest[j] = high;
    state.group_farthest = std::max(state.group_farthest, high);
}

/// What no sample of the group can see is farther than this.
HWY_NOINLINE void refresh_farthest(const KernelScene& scene, KernelState& state) {
    state.group_farthest = -kNever;
    for (std::uint32_t k = 0; k < state.tiles; ++k) {
        const std::uint32_t j = state.first_lane + k;
        if (state.untouched >> j & 1) {
            spread_farthest(k, state);
            continue;
        }
        Floats high = set(-kNever);
        VectorLimits* limits = limits_of(scene, j, state);
        const std::uint32_t first = state.tile_vectors[k];
        for (std::uint32_t i = state.tile_vectors[k]; i < state.tile_vectors[k + 1]; ++i) {
            const Mask valid = mask_of(scene.tiles->valid[state.first_vector + i]);
            const Floats own = choose(valid, load(state.nearest[i].high), set(-kNever));
            high = largest(high, own);
            const float farthest = largest_lane(own);
            if (limits) limits[(i - first) / kLanes].farthest[(i - first) % kLanes] = farthest;
            if (state.beams_made) state.beams[i / kLanes].farthest[i % kLanes] = farthest;
        }
        state.farthest[state.first_lane + k] = largest_lane(high);
        state.group_farthest = std::max(state.group_farthest, state.farthest[state.first_lane + k]);
    }
}

/// The nearest comes last. `number`: the node's.
HWY_INLINE void push_children(const WideNode& node, std::uint32_t number, const Children& children,
                              std::vector<Waiting>& stack) {
    const std::size_t base = stack.size();
    stack.resize(base + static_cast<std::size_t>(std::popcount(children.lanes)));
    Waiting* const to = stack.data() + base;
    alignas(64) float nearest[kLanes];
    store(children.nearest, nearest);
    for (Each lane(children.lanes); lane; ++lane) {
        const Floats own = set(nearest[*lane]);
        const std::uint32_t farther = bits(children.nearest > own),
                            as_far = bits(children.nearest >= own) & first_lanes(*lane);
        to[std::popcount(children.lanes & (farther | as_far))] = {nearest[*lane], node.child[*lane], number,
                                                                  *lane};
    }
}

HWY_INLINE void prefetch_child(const LeafTree& tree, std::int32_t child) {
    const char* from = child < 0
                           ? reinterpret_cast<const char*>(&tree.leaves[static_cast<std::size_t>(~child)])
                           : reinterpret_cast<const char*>(&tree.nodes[static_cast<std::size_t>(child)]);
    for (int line = 0; line < 11; ++line) hwy::Prefetch(from + 64 * line);
}

/// Whether some vector's beam reaches the node before its samples all see something nearer.
HWY_INLINE bool reaches_some_vector(const LeafTree& tree, const KernelState& state, const Waiting& next) {
    const WideNode& parent = tree.nodes[next.parent];
    float middle[3], half[3];
    for (int a = 0; a < 3; ++a) {
        const float low = parent.low[a][next.lane], high = parent.high[a][next.lane];
        middle[a] = 0.5f * (low + high);
        half[a] = 0.500001f * (high - low);
    }
    PlaneHeights unused;
    for (const VectorBeams& beams : state.beams) {
        if (vectors_at_box(beams, middle, half, next.nearest, unused)) return true;
    }
    return false;
}

/// Finds the nearest sure hit of every sample of the group, and lists the doubtful triangles.
HWY_NOINLINE void walk_group(const KernelScene& scene, LeafMode mode, KernelState& state) {
    constexpr int kLeavesBetweenLooks = 8, kLooksBeforeBeams = 3;  // measured
    constexpr std::size_t kFetchedAhead = 2;                       // likewise
    const LeafTree& tree = *scene.tree;
    int leaves = 0, looks = state.beams_made ? 1 : 0;
    state.stack.clear();
    if (!tree.empty()) state.stack.push_back({-kNever, tree.root, 0, 0});
    while (!state.stack.empty()) {
        const Waiting next = state.stack.back();
        state.stack.pop_back();
        if (next.nearest > state.group_farthest) continue;
        if (state.stack.size() >= kFetchedAhead)
            prefetch_child(tree, state.stack[state.stack.size() - kFetchedAhead].child);
        if (next.child < 0) {
            draw_leaf(scene, tree.leaves[static_cast<std::size_t>(~next.child)], next.nearest, mode, state);
            if (++leaves % kLeavesBetweenLooks != 0) continue;
            refresh_farthest(scene, state);
            if (++looks == kLooksBeforeBeams && !state.beams_made) make_vector_beams(scene, state);
            continue;
        }
        if (state.beams_made && looks > 0 && next.child != tree.root &&
            !reaches_some_vector(tree, state, next))
            continue;
        const auto number = static_cast<std::uint32_t>(next.child);
        const WideNode& node = tree.nodes[number];
        const std::size_t base = state.stack.size();
        push_children(node, number, reached_children(state.beam, node, state.group_farthest), state.stack);
        const std::size_t waiting = state.stack.size();
        for (std::size_t i = waiting; i > base && i + kFetchedAhead > waiting; --i)
            prefetch_child(tree, state.stack[i - 1].child);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
