// The walk: a group of tiles goes down the tree together, nearest nodes first, with one beam around all; at a
// leaf the cheapest of three modes draws. Included once per instruction set.
#if defined(TRILENS_KERNEL_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WALK_INL_H
#undef TRILENS_KERNEL_WALK_INL_H
#else
#define TRILENS_KERNEL_WALK_INL_H
#endif

#include <algorithm>
#include <bit>

#include "projector/kernel/beams-inl.h"
#include "projector/kernel/leaf_facets-inl.h"
#include "projector/kernel/leaf_rays-inl.h"
#include "projector/kernel/leaf_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// The leaf's middle from the tree's centre, as floats: off by half a unit in the last place, which
/// kPlaneErrorBound includes.
HWY_INLINE void middle_in_tree(const LeafTree& tree, const Leaf& leaf, float (&middle)[3]) {
    for (int a = 0; a < 3; ++a) middle[a] = static_cast<float>(leaf.centre[a] - tree.centre[a]);
}

/// The group's tiles whose beams reach the leaf, before all their samples see something nearer.
HWY_INLINE std::uint32_t tiles_at_leaf(const KernelState& state, const Leaf& leaf, const float (&middle)[3],
                                       float nearest) {
    const std::uint32_t own = first_lanes(state.group.tiles) << state.group.first_lane;
    if (state.group.tiles == 1 || state.beam.planes == 0) return own;
    const Floats cx = set(middle[0]), cy = set(middle[1]), cz = set(middle[2]);
    const Floats hx = set(leaf.half[0]), hy = set(leaf.half[1]), hz = set(leaf.half[2]);
    Mask missed = set(nearest) > load(state.seen.farthest);
    for (int k = 0; k < 4; ++k) {
        const Floats x = load(state.lanes.hull.plane[k][0]), y = load(state.lanes.hull.plane[k][1]),
                     z = load(state.lanes.hull.plane[k][2]);
        const Floats swing = multiply_add(absolute(x), hx, multiply_add(absolute(y), hy, absolute(z) * hz));
        const Floats height = multiply_add(x, cx, multiply_add(y, cy, multiply_add(z, cz, swing)));
        missed = missed | (height < load(state.lanes.hull.offset[k]));
    }
    return own & ~bits(missed);
}

/// The leaf's triangles that the group's beam may reach.
HWY_INLINE std::uint32_t triangles_in_beam(const GroupBeam& beam, const Leaf& leaf,
                                           const float (&middle)[3]) {
    std::uint32_t missed = 0;
    for (int p = 0; p < beam.planes; ++p) {
        const float* n = beam.plane[p];
        const Floats x = set(n[0]), y = set(n[1]), z = set(n[2]);
        const Floats at = set(n[0] * middle[0] + n[1] * middle[1] + n[2] * middle[2]);
        Floats height = set(-kNever);
        for (int k = 0; k < 3; ++k)
            height = largest(height, multiply_add(x, load(leaf.x[k]),
                                                  multiply_add(y, load(leaf.y[k]), z * load(leaf.z[k]))));
        missed |= bits(height + at < set(beam.offset[p]));
    }
    return first_lanes(leaf.count) & ~missed;
}

HWY_NOINLINE void make_edges(const Leaf& leaf, LeafEdges& edges) {
    Floats l[3][3];
    const Floats x[3] = {load(leaf.x[0]), load(leaf.x[1]), load(leaf.x[2])};
    const Floats y[3] = {load(leaf.y[0]), load(leaf.y[1]), load(leaf.y[2])};
    const Floats z[3] = {load(leaf.z[0]), load(leaf.z[1]), load(leaf.z[2])};
    for (int k = 0; k < 3; ++k) {
        const int a = (k + 1) % 3, b = (k + 2) % 3;
        l[k][0] = x[b] - x[a];
        l[k][1] = y[b] - y[a];
        l[k][2] = z[b] - z[a];
        for (int c = 0; c < 3; ++c) store(l[k][c], edges.edge[k][c]);
        store(multiply_subtract(y[a], z[b], z[a] * y[b]), edges.moment[k][0]);
        store(multiply_subtract(z[a], x[b], x[a] * z[b]), edges.moment[k][1]);
        store(multiply_subtract(x[a], y[b], y[a] * x[b]), edges.moment[k][2]);
    }
    const Floats nx = multiply_subtract(l[1][1], l[2][2], l[1][2] * l[2][1]);
    const Floats ny = multiply_subtract(l[1][2], l[2][0], l[1][0] * l[2][2]);
    const Floats nz = multiply_subtract(l[1][0], l[2][1], l[1][1] * l[2][0]);
    store(nx, edges.normal[0]);
    store(ny, edges.normal[1]);
    store(nz, edges.normal[2]);
    store(multiply_add(nx, x[0], multiply_add(ny, y[0], nz * z[0])), edges.height);
}

/// How many samples see an average triangle of the leaf, if it faces them: from the area of the leaf's box
/// and how far apart neighbouring rays are at t.
HWY_INLINE float samples_per_triangle(const float (&pitch)[4], const Leaf& leaf, float t) {
    const float far = std::max(t, 0.0f);
    const float pitch_u = pitch[0] + far * pitch[1], pitch_v = pitch[2] + far * pitch[3];
    const float* h = leaf.half;
    return 2 * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0]) /
           (pitch_u * pitch_v * static_cast<float>(leaf.count));
}

/// Measured: below this many samples per triangle, rays are faster: for one tile, whose conics serve many
/// samples, and for several small ones.
inline constexpr float kRaysBelow = 4, kRaysBelowAtTiles = 32;

/// By what mode tiles and triangles that may meet are drawn fastest (measured).
HWY_INLINE LeafMode cheapest_mode(const KernelState& state, const Leaf& leaf, float nearest, int tiles,
                                  int triangles, bool pixels) {
    if (pixels)
        return tiles > 1 && triangles + 0.7f < 2.0f * tiles ? LeafMode::kFacets : LeafMode::kTriangles;
    const float rays_below = state.group.tiles > 1 ? kRaysBelowAtTiles : kRaysBelow;
    if (samples_per_triangle(state.beam.pitch, leaf, nearest) < rays_below) return LeafMode::kRays;
    return tiles > 1 && triangles + 0.7f < 2.0f * tiles ? LeafMode::kFacets : LeafMode::kTriangles;
}

HWY_NOINLINE void draw_leaf(const KernelScene& scene, const Leaf& leaf, float nearest, LeafMode mode,
                            KernelState& state) {
    float middle[3];
    middle_in_tree(*scene.tree, leaf, middle);
    const std::uint32_t tiles = tiles_at_leaf(state, leaf, middle, nearest);
    if (!tiles) return;
    std::uint32_t triangles = first_lanes(leaf.count);
    if (state.group.tiles > 1) triangles = triangles_in_beam(state.beam, leaf, middle);
    if (!triangles) return;
    make_edges(leaf, state.work.edges);
    if (mode == LeafMode::kCheapest)
        mode =
            cheapest_mode(state, leaf, nearest, std::popcount(tiles), std::popcount(triangles), scene.pixels);
    if (mode == LeafMode::kRays) return draw_ray_lanes(scene, leaf, middle, nearest, state);
    if (mode == LeafMode::kFacets) return draw_facet_lanes(scene, leaf, triangles, tiles, state);
    for (Each lane(tiles); lane; ++lane) draw_triangle_lanes(scene, leaf, *lane, state);
}

// The walk: a group of tiles goes down the tree together, nearest nodes first, with one beam around all.

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
    const std::uint32_t j = state.group.first_lane + k;
    const float high = state.seen.covered >> j & 1 ? state.seen.whole[j].farthest : kNever;
    if (state.work.beams_made) {
        for (std::uint32_t i = state.group.tile_vectors[k]; i < state.group.tile_vectors[k + 1]; ++i)
            state.work.beams[i / kLanes].farthest[i % kLanes] = high;
    }
    state.seen.farthest[j] = high;
    state.seen.all_farthest = std::max(state.seen.all_farthest, high);
}

/// What no sample of the group can see is farther than this.
HWY_NOINLINE void refresh_farthest(const KernelScene& scene, KernelState& state) {
    state.seen.all_farthest = -kNever;
    for (std::uint32_t k = 0; k < state.group.tiles; ++k) {
        const std::uint32_t j = state.group.first_lane + k;
        if (state.seen.untouched >> j & 1) {
            spread_farthest(k, state);
            continue;
        }
        Floats high = set(-kNever);
        VectorLimits* limits = limits_of(scene, j, state);
        const std::uint32_t first = state.group.tile_vectors[k];
        for (std::uint32_t i = state.group.tile_vectors[k]; i < state.group.tile_vectors[k + 1]; ++i) {
            const Mask valid = mask_of(scene.tiles->valid[state.group.first_vector + i]);
            Floats own = choose(valid, load(state.seen.nearest[i].high), set(-kNever));
            if (scene.pixels && !scene.open) own = least(own, load(state.seen.doubts[i].low));
            high = largest(high, own);
            const float farthest = largest_lane(own);
            if (limits) limits[(i - first) / kLanes].farthest[(i - first) % kLanes] = farthest;
            if (state.work.beams_made) state.work.beams[i / kLanes].farthest[i % kLanes] = farthest;
        }
        state.seen.farthest[state.group.first_lane + k] = largest_lane(high);
        state.seen.all_farthest =
            std::max(state.seen.all_farthest, state.seen.farthest[state.group.first_lane + k]);
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
    for (const VectorBeams& beams : state.work.beams) {
        if (vectors_at_box(beams, middle, half, next.nearest, unused)) return true;
    }
    return false;
}

/// Finds the nearest sure hit of every sample of the group, and lists the ambiguous triangles.
HWY_NOINLINE void walk_group(const KernelScene& scene, LeafMode mode, KernelState& state) {
    constexpr int kLeavesBetweenLooks = 8, kLooksBeforeBeams = 3;  // measured
    constexpr std::size_t kFetchedAhead = 2;                       // likewise
    const LeafTree& tree = *scene.tree;
    int leaves = 0, looks = state.work.beams_made ? 1 : 0;
    state.work.stack.clear();
    if (!tree.empty()) state.work.stack.push_back({-kNever, tree.root, 0, 0});
    while (!state.work.stack.empty()) {
        const Waiting next = state.work.stack.back();
        state.work.stack.pop_back();
        if (next.nearest > state.seen.all_farthest) continue;
        if (state.work.stack.size() >= kFetchedAhead)
            prefetch_child(tree, state.work.stack[state.work.stack.size() - kFetchedAhead].child);
        if (next.child < 0) {
            draw_leaf(scene, tree.leaves[static_cast<std::size_t>(~next.child)], next.nearest, mode, state);
            if (++leaves % kLeavesBetweenLooks != 0) continue;
            refresh_farthest(scene, state);
            if (++looks == kLooksBeforeBeams && !state.work.beams_made) make_vector_beams(scene, state);
            continue;
        }
        if (state.work.beams_made && looks > 0 && next.child != tree.root &&
            !reaches_some_vector(tree, state, next))
            continue;
        const auto number = static_cast<std::uint32_t>(next.child);
        const WideNode& node = tree.nodes[number];
        const std::size_t base = state.work.stack.size();
        push_children(node, number, reached_children(state.beam, node, state.seen.all_farthest),
                      state.work.stack);
        const std::size_t waiting = state.work.stack.size();
        for (std::size_t i = waiting; i > base && i + kFetchedAhead > waiting; --i)
            prefetch_child(tree, state.work.stack[i - 1].child);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
