// The walk: a group of tiles goes down the tree together, nearest nodes first, with one beam around all.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WALK_INL_H
#undef TRILENS_KERNEL_WALK_INL_H
#else
#define TRILENS_KERNEL_WALK_INL_H
#endif

#include <algorithm>

#include "projector/kernel_group_beam-inl.h"
#include "projector/kernel_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// The children that no plane of the beam cuts off, and the least t of each.
HWY_INLINE std::uint32_t reached_children(const GroupBeam& beam, const WideNode& node, float* nearest) {
    std::uint32_t missed = 0;
    for (int p = 0; p < beam.planes; ++p) {
        const float* n = beam.plane[p];
        const Floats height =
            multiply_add(set(n[0]), load(n[0] > 0 ? node.high[0] : node.low[0]),
                         multiply_add(set(n[1]), load(n[1] > 0 ? node.high[1] : node.low[1]),
                                      set(n[2]) * load(n[2] > 0 ? node.high[2] : node.low[2])));
        missed |= bits(height < set(beam.offset[p]));
    }
    const float* n = beam.axis;
    const Floats ahead = multiply_add(set(n[0]), load(n[0] > 0 ? node.low[0] : node.high[0]),
                                      multiply_add(set(n[1]), load(n[1] > 0 ? node.low[1] : node.high[1]),
                                                   set(n[2]) * load(n[2] > 0 ? node.low[2] : node.high[2])));
    store((ahead - set(beam.start)) * set(beam.speed_inverse), nearest);
    return first_lanes(node.count) & ~missed;
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
        for (std::uint32_t i = state.tile_vectors[k]; i < state.tile_vectors[k + 1]; ++i) {
            const Mask valid = mask_of(scene.tiles->valid[state.first_vector + i]);
            const Floats own = choose(valid, load(state.nearest[i].high), set(-kNever));
            high = largest(high, own);
            if (state.beams_made) state.beams[i / kLanes].farthest[i % kLanes] = largest_lane(own);
        }
        state.farthest[state.first_lane + k] = largest_lane(high);
        state.group_farthest = std::max(state.group_farthest, state.farthest[state.first_lane + k]);
    }
}

HWY_INLINE void push_child(std::vector<Waiting>& stack, std::size_t base, const Waiting& next) {
    std::size_t at = stack.size();
    stack.push_back(next);
    for (; at > base && stack[at - 1].nearest < next.nearest; --at) stack[at] = stack[at - 1];
    stack[at] = next;
}

HWY_INLINE void prefetch_child(const LeafTree& tree, std::int32_t child) {
    const char* from = child < 0
                           ? reinterpret_cast<const char*>(&tree.leaves[static_cast<std::size_t>(~child)])
                           : reinterpret_cast<const char*>(&tree.nodes[static_cast<std::size_t>(child)]);
    for (int line = 0; line < 11; ++line) hwy::Prefetch(from + 64 * line);
}

/// One child of a node, ready to wait.
HWY_INLINE Waiting waiting_child(const WideNode& node, std::size_t lane, float nearest) {
    Waiting next;
    next.nearest = nearest;
    next.child = node.child[lane];
    for (int a = 0; a < 3; ++a) {
        next.middle[a] = 0.5f * (node.low[a][lane] + node.high[a][lane]);
        next.half[a] = 0.500001f * (node.high[a][lane] - node.low[a][lane]);
    }
    return next;
}

/// Whether some vector's beam reaches the node before its samples all see something nearer.
HWY_INLINE bool reaches_some_vector(const KernelState& state, const Waiting& node) {
    for (const VectorBeams& beams : state.beams) {
        if (vectors_at_box(beams, node.middle, node.half, node.nearest)) return true;
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
    if (!tree.empty()) state.stack.push_back({-kNever, tree.root, {0, 0, 0}, {kNever, kNever, kNever}});
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
        if (state.beams_made && looks > 0 && next.child != tree.root && !reaches_some_vector(state, next))
            continue;
        const WideNode& node = tree.nodes[static_cast<std::size_t>(next.child)];
        alignas(64) float nearest[kLanes];
        const std::size_t base = state.stack.size();
        for (Each lane(reached_children(state.beam, node, nearest)); lane; ++lane) {
            if (!(nearest[*lane] > state.group_farthest))
                push_child(state.stack, base, waiting_child(node, *lane, nearest[*lane]));
        }
        const std::size_t waiting = state.stack.size();
        for (std::size_t i = waiting; i > base && i + kFetchedAhead > waiting; --i)
            prefetch_child(tree, state.stack[i - 1].child);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
