// The walk: a group of tiles goes down the tree together, nearest nodes first, with one beam around all.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_WALK_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WALK_INL_H
#undef TRILENS_KERNEL_WALK_INL_H
#else
#define TRILENS_KERNEL_WALK_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel_leaf-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// The corner rays of a group's tiles, one after the other; origins from the tree's centre.
struct HullRays {
    double origin[3][4 * kLanes], direction[3][4 * kLanes];
    std::size_t count = 0;
    double size = 0;  // largest origin in the 1-norm, and the tree's
};

HWY_NOINLINE void gather_hulls(const KernelScene& scene, const KernelState& state, HullRays& rays) {
    const Vec3& centre = scene.tree->centre;
    const Vec3& half = scene.tree->half;
    rays.count = 0;
    double size = 0;
    for (std::size_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        for (std::size_t k = 0; k < 4; ++k) {
            double own = 1e-6 * state.lanes.origin_terms[j];
            for (int a = 0; a < 3; ++a) {
                const double from_tree = state.lanes.centre[a][j] - centre[a];
                rays.origin[a][rays.count] = state.lanes.hull.origin[k][a][j] + from_tree;
                rays.direction[a][rays.count] = state.lanes.hull.direction[k][a][j];
                own += std::fabs(state.lanes.hull.origin[k][a][j]) + std::fabs(from_tree);
            }
            size = std::max(size, own);
            ++rays.count;
        }
    }
    rays.size = size + half.x + half.y + half.z;
}

HWY_INLINE double dot3(const double (*v)[4 * kLanes], std::size_t i, const double* n) {
    return v[0][i] * n[0] + v[1][i] * n[1] + v[2][i] * n[2];
}

/// Adds the plane with this normal, turned towards the axis by more than it rounds, if it then holds.
HWY_NOINLINE void add_plane(const HullRays& rays, const double* normal, const double* axis, double cosine,
                            GroupBeam& beam) {
    double length = 0, n[3];
    for (int a = 0; a < 3; ++a) length += normal[a] * normal[a];
    if (!(length > 0) || !(cosine > 0)) return;
    const int at = beam.planes;
    for (int a = 0; a < 3; ++a) {
        const double turned = normal[a] / std::sqrt(length) + 0x1p-21 / cosine * axis[a];
        beam.plane[at][a] = static_cast<float>(turned);
        n[a] = beam.plane[at][a];
    }
    double offset = INFINITY;
    for (std::size_t i = 0; i < rays.count; ++i) {
        if (!(dot3(rays.direction, i, n) >= 0)) return;
        offset = std::min(offset, dot3(rays.origin, i, n));
    }
    beam.offset[at] = static_cast<float>(offset - kPlaneDoubt * rays.size);
    ++beam.planes;
}

/// Around all of the group's rays: two pairs of planes along the mean direction and one across it.
HWY_NOINLINE void make_group_beam(const KernelScene& scene, const KernelState& state, GroupBeam& beam) {
    HullRays rays;
    gather_hulls(scene, state, rays);
    beam.planes = 0;
    double axis[3] = {0, 0, 0}, length = 0;
    for (std::size_t i = 0; i < rays.count; ++i) {
        double own = 0;
        for (int a = 0; a < 3; ++a) own += rays.direction[a][i] * rays.direction[a][i];
        own = own > 0 ? 1 / std::sqrt(own) : 0;
        for (int a = 0; a < 3; ++a) axis[a] += own * rays.direction[a][i];
    }
    for (const double a : axis) length += a * a;
    beam.start = 0;
    beam.speed_inverse = 0;
    if (!(length > 1e-12)) return;
    for (int a = 0; a < 3; ++a) {
        beam.axis[a] = static_cast<float>(axis[a] / std::sqrt(length));
        axis[a] = beam.axis[a];
    }

    double speed = 0, start = -INFINITY, cosine = 1;
    for (std::size_t i = 0; i < rays.count; ++i) {
        const double along = dot3(rays.direction, i, axis);
        double own = 0;
        for (int a = 0; a < 3; ++a) own += rays.direction[a][i] * rays.direction[a][i];
        cosine = std::min(cosine, along / std::sqrt(own));
        speed = std::max(speed, along);
        start = std::max(start, dot3(rays.origin, i, axis));
    }
    beam.start = static_cast<float>(start + kPlaneDoubt * rays.size);
    beam.speed_inverse = speed > 0 ? static_cast<float>((1 - 1e-6) / speed) : 0;
    if (!(cosine > 1e-3)) return;

    add_plane(rays, axis, axis, cosine, beam);
    if (state.tiles == 1) {
        for (int k = 0; k < 4; ++k) {
            if (!(state.lanes.hull.offset[k][state.first_lane] > -kNever)) continue;
            for (int a = 0; a < 3; ++a)
                beam.plane[beam.planes][a] = state.lanes.hull.plane[k][a][state.first_lane];
            beam.offset[beam.planes++] = state.lanes.hull.offset[k][state.first_lane];
        }
        return;
    }
    // Across the axis: where it is smallest, made square to it.
    const int least = std::fabs(axis[0]) <= std::fabs(axis[1])
                          ? (std::fabs(axis[0]) <= std::fabs(axis[2]) ? 0 : 2)
                          : (std::fabs(axis[1]) <= std::fabs(axis[2]) ? 1 : 2);
    double across[2][3];
    for (int a = 0; a < 3; ++a) across[0][a] = (a == least ? 1 : 0) - axis[least] * axis[a];
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        across[1][a] = axis[b] * across[0][c] - axis[c] * across[0][b];
    }
    for (const double* side : {across[0], across[1]}) {
        double low = INFINITY, high = -INFINITY;
        for (std::size_t i = 0; i < rays.count; ++i) {
            const double slope = dot3(rays.direction, i, side) / dot3(rays.direction, i, axis);
            low = std::min(low, slope);
            high = std::max(high, slope);
        }
        double n[3];
        for (int a = 0; a < 3; ++a) n[a] = side[a] - low * axis[a];
        add_plane(rays, n, axis, cosine, beam);
        for (int a = 0; a < 3; ++a) n[a] = high * axis[a] - side[a];
        add_plane(rays, n, axis, cosine, beam);
    }
}

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

/// What no sample of the group can see is farther than this.
HWY_NOINLINE void refresh_farthest(const KernelScene& scene, KernelState& state) {
    state.group_farthest = -kNever;
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
        const std::uint32_t first = tile.first_vector - state.first_vector;
        Floats high = set(-kNever);
        for (std::uint32_t i = first; i < first + tile.vectors; ++i) {
            const Mask valid = mask_of(scene.tiles->samples[state.first_vector + i].valid);
            const Floats own = choose(valid, load(state.nearest[i].high), set(-kNever));
            high = largest(high, own);
            if (state.beams_made) state.beams[i / kLanes].farthest[i % kLanes] = largest_lane(own);
        }
        state.farthest[j] = largest_lane(high);
        state.group_farthest = std::max(state.group_farthest, state.farthest[j]);
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
    const LeafTree& tree = *scene.tree;
    int leaves = 0, looks = 0;
    state.stack.clear();
    if (!tree.empty()) state.stack.push_back({-kNever, tree.root, {0, 0, 0}, {kNever, kNever, kNever}});
    while (!state.stack.empty()) {
        const Waiting next = state.stack.back();
        state.stack.pop_back();
        if (next.nearest > state.group_farthest) continue;
        if (!state.stack.empty()) prefetch_child(tree, state.stack.back().child);
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
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
