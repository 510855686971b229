// Beams around single vectors of samples, 16 at once, and what reaches into them.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_VECTOR_BEAMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_VECTOR_BEAMS_INL_H
#undef TRILENS_KERNEL_VECTOR_BEAMS_INL_H
#else
#define TRILENS_KERNEL_VECTOR_BEAMS_INL_H
#endif

#include <algorithm>
#include <cstring>
#include <limits>

#include "projector/kernel/kernel_setup-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// Beams around all of the group's vectors, 16 at a time.
HWY_NOINLINE void make_vector_beams(const KernelScene& scene, KernelState& state) {
    state.beams_made = true;
    state.rays_made.assign(state.vectors, 0);
    state.tile_of_vector.resize(state.vectors);
    if (state.rays.size() < state.vectors) state.rays.resize(state.vectors);
    state.beams.resize((state.vectors + kLanes - 1) / kLanes);
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
        std::fill_n(state.tile_of_vector.begin() + (tile.first_vector - state.first_vector), tile.vectors,
                    static_cast<std::uint8_t>(j));
    }
    HullLanes hull;
    for (std::uint32_t g = 0; g * kLanes < state.vectors; ++g) {
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            const std::uint32_t vector =
                std::min(g * static_cast<std::uint32_t>(kLanes) + k, state.vectors - 1);
            const std::size_t j = state.tile_of_vector[vector];
            const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
            const std::uint32_t own = vector + state.first_vector - tile.first_vector;
            const VectorBoxes& box = scene.tiles->boxes[tile.first_boxes + own / kLanes];
            const std::size_t b = own % kLanes;
            // No thinner than a third of a sample, so that the hull has sides.
            const double half_u = std::max<double>(box.half_u[b], 0.6 / std::max(1, tile.width - 1)),
                         half_v = std::max<double>(box.half_v[b], 0.6 / std::max(1, tile.height - 1));
            const double weight =
                put_rectangle(state.lanes, j, {box.centre_u[b], box.centre_v[b], half_u, half_v}, hull, k);
            for (int a = 0; a < 3; ++a) hull.centre[a][k] = state.lanes.centre[a][j];
            hull.origin_terms[k] =
                weight > 0.1 ? state.lanes.origin_terms[j] : std::numeric_limits<double>::infinity();
        }
        make_planes(scene, hull);
        VectorBeams& beams = state.beams[g];
        std::memcpy(beams.plane, hull.plane, sizeof beams.plane);
        std::memcpy(beams.offset, hull.offset, sizeof beams.offset);
        for (std::uint32_t k = 0; k < kLanes; ++k)
            beams.farthest[k] = g * kLanes + k < state.vectors ? kNever : -kNever;
    }
}

/// The offsets of vectors' planes as seen from a box's middle.
struct alignas(64) PlaneHeights {
    float from_middle[4][kLanes];
};

/// Which of 16 vectors' beams reach a box, before their samples all see something nearer. Fills `heights`.
HWY_INLINE std::uint32_t vectors_at_box(const VectorBeams& beams, const float* middle, const float* half,
                                        float nearest, PlaneHeights& heights) {
    const Floats cx = set(middle[0]), cy = set(middle[1]), cz = set(middle[2]);
    const Floats hx = set(half[0]), hy = set(half[1]), hz = set(half[2]);
    Mask missed = set(nearest) > load(beams.farthest);
    for (int k = 0; k < 4; ++k) {
        const Floats x = load(beams.plane[k][0]), y = load(beams.plane[k][1]), z = load(beams.plane[k][2]);
        const Floats swing = multiply_add(absolute(x), hx, multiply_add(absolute(y), hy, absolute(z) * hz));
        const Floats height =
            subtract_product(x, cx, subtract_product(y, cy, subtract_product(z, cz, load(beams.offset[k]))));
        store(height, heights.from_middle[k]);
        missed = missed | (swing < height);
    }
    return kAllLanes & ~bits(missed);
}

/// The leaf's triangles that reach into one vector's beam. `heights`: of the planes over the leaf's middle.
HWY_INLINE std::uint32_t triangles_in_vector(const VectorBeams& beams, const PlaneHeights& heights,
                                             std::size_t lane, const Leaf& leaf) {
    Mask missed = mask_of(0);
    for (int p = 0; p < 4; ++p) {
        const Floats x = set(beams.plane[p][0][lane]), y = set(beams.plane[p][1][lane]),
                     z = set(beams.plane[p][2][lane]);
        Floats height = set(-kNever);
        for (int k = 0; k < 3; ++k)
            height = largest(height, multiply_add(x, load(leaf.x[k]),
                                                  multiply_add(y, load(leaf.y[k]), z * load(leaf.z[k]))));
        missed = missed | (height < set(heights.from_middle[p][lane]));
    }
    return first_lanes(leaf.count) & ~bits(missed);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
