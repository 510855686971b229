// A leaf: which tiles and triangles can meet, and which mode draws them cheapest.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_LEAF_INL_H
#undef TRILENS_KERNEL_LEAF_INL_H
#else
#define TRILENS_KERNEL_LEAF_INL_H
#endif

#include "projector/kernel/kernel_facets-inl.h"
#include "projector/kernel/kernel_rays-inl.h"
#include "projector/kernel/kernel_triangles-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// The leaf's middle from the tree's centre, as floats: off by half a unit in the last place, which
/// kPlaneDoubt includes.
HWY_INLINE void middle_in_tree(const LeafTree& tree, const Leaf& leaf, float (&middle)[3]) {
    for (int a = 0; a < 3; ++a) middle[a] = static_cast<float>(leaf.centre[a] - tree.centre[a]);
}

/// The group's tiles whose beams reach the leaf, before all their samples see something nearer.
HWY_INLINE std::uint32_t tiles_at_leaf(const KernelState& state, const Leaf& leaf, const float (&middle)[3],
                                       float nearest) {
    const std::uint32_t own = first_lanes(state.tiles) << state.first_lane;
    if (state.tiles == 1 || state.beam.planes == 0) return own;
    const Floats cx = set(middle[0]), cy = set(middle[1]), cz = set(middle[2]);
    const Floats hx = set(leaf.half[0]), hy = set(leaf.half[1]), hz = set(leaf.half[2]);
    Mask missed = set(nearest) > load(state.farthest);
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
                                  int triangles) {
    const float rays_below = state.tiles > 1 ? kRaysBelowAtTiles : kRaysBelow;
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
    if (state.tiles > 1) triangles = triangles_in_beam(state.beam, leaf, middle);
    if (!triangles) return;
    make_edges(leaf, state.edges);
    if (mode == LeafMode::kCheapest)
        mode = cheapest_mode(state, leaf, nearest, std::popcount(tiles), std::popcount(triangles));
    if (mode == LeafMode::kRays) return draw_ray_lanes(scene, leaf, middle, nearest, state);
    if (mode == LeafMode::kFacets) return draw_facet_lanes(scene, leaf, triangles, tiles, state);
    for (Each lane(tiles); lane; ++lane) draw_triangle_lanes(scene, leaf, *lane, state);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
