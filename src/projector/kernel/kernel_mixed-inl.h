// Vectors whose samples have facets of their own: their rays, facet by facet, and what they surely see.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_MIXED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_MIXED_INL_H
#undef TRILENS_KERNEL_MIXED_INL_H
#else
#define TRILENS_KERNEL_MIXED_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel/kernel_mixed_beams-inl.h"
#include "projector/kernel/kernel_resolve-inl.h"
#include "projector/kernel/kernel_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// Samples' rays, and the centres of their facets in the world frame.
struct OwnRays {
    RayLanes ray;
    Vector3 centre;
};

HWY_INLINE Vector3 choose(const hn::Mask<DoubleTag>& m, const Vector3& yes, const Vector3& no) {
    return {hn::IfThenElse(m, yes.x, no.x), hn::IfThenElse(m, yes.y, no.y), hn::IfThenElse(m, yes.z, no.z)};
}

/// Through places `x`, `y` of the film.
HWY_INLINE OwnRays rays_through(const FacetRays& facet, const Double& x, const Double& y) {
    return {ray_lanes(facet.rays, hn::Sub(x, hn::Set(kDouble, facet.screen.x)),
                      hn::Sub(y, hn::Set(kDouble, facet.screen.y))),
            set3(facet.centre)};
}

/// The rays of a vector's samples: with the bits of FacetRays::at in `exact`, where that is wanted; and in
/// `to` with the weight divided out and origins from the group's centre.
HWY_NOINLINE void make_mixed_rays(const KernelScene& scene, const MixedGroup& group, std::uint32_t in_group,
                                  MixedRays* exact, VectorRays& to) {
    const SampleVector& samples = scene.tiles->vectors[group.first_vector + in_group];
    const LaneFacets& facets = scene.tiles->lanes[group.first_lanes + in_group];
    const SampleGrid& grid = *scene.grid;
    const TileSpots window{{1, 1},    {0, 0}, {0, 0}, {grid.x0, grid.y0}, {grid.x0 + 0.5, grid.y0 + 0.5},
                           grid.side, {0, 0}, 0};
    const Words ids = load_words(facets.rays);
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        const Double x = offsets_of(window, 0, samples.u + at), y = offsets_of(window, 1, samples.v + at);
        const auto lanes_of = [&](Id id) HWY_ATTR {
            return bits(same(ids, set_word(id))) >> at & first_lanes(kDoubles);
        };
        const Id first = facets.rays[at];
        OwnRays own = rays_through(scene.tiles->rays[first], x, y);
        for (std::uint32_t left = first_lanes(kDoubles) & ~lanes_of(first); left != 0;) {
            const Id id = facets.rays[at + static_cast<std::size_t>(std::countr_zero(left))];
            const std::uint32_t lanes = lanes_of(id);
            left &= ~lanes;
            const auto mask = mask_of_doubles(lanes);
            const OwnRays other = rays_through(scene.tiles->rays[id], x, y);
            own.ray.origin = choose(mask, other.ray.origin, own.ray.origin);
            own.ray.direction = choose(mask, other.ray.direction, own.ray.direction);
            own.ray.weight = hn::IfThenElse(mask, other.ray.weight, own.ray.weight);
            own.centre = choose(mask, other.centre, own.centre);
        }
        if (exact) {
            store3(own.ray.origin, exact->origin, at);
            store3(own.ray.direction, exact->direction, at);
            store3(own.centre, exact->centre, at);
            hn::Store(own.ray.weight, kDouble, exact->weight + at);
        }
        const Double inverse = hn::Div(hn::Set(kDouble, 1.0), own.ray.weight);
        const Vector3 from_group = minus(own.centre, set3(group.centre));
        store3(plus(times(inverse, own.ray.origin), from_group), to.origin, at);
        store3(times(inverse, own.ray.direction), to.direction, at);
    }
}

/// A share of what the next group will read, so that its misses are over by then.
HWY_INLINE void prefetch_mixed(const SampleTiles& tiles, const MixedGroup* next, std::uint32_t vector) {
    if (!next || vector >= next->vectors) return;
    const auto fetch = [](const auto* first, std::size_t count) HWY_ATTR {
        const char* from = reinterpret_cast<const char*>(first);
        for (std::size_t at = 0; at < count * sizeof *first; at += 64) hwy::Prefetch(from + at);
    };
    const std::uint32_t share = (next->facets + next->vectors - 1) / next->vectors,
                        first = std::min(vector * share, next->facets);
    fetch(&tiles.rays[next->first_rays + first], std::min(share, next->facets - first));
    fetch(&tiles.vectors[next->first_vector + vector], 1);
    fetch(&tiles.lanes[next->first_lanes + vector], 1);
}

/// Rays and beams of the group's vectors that `state` names. False: they have no bounds.
HWY_NOINLINE bool set_up_mixed(const KernelScene& scene, const MixedGroup& group, KernelState& state) {
    constexpr double kMostTerms = 1e6;  // that bounds are any good for
    TileLanes& lanes = state.lanes;
    if (!(group.weight_terms < kMostTerms) || !std::isfinite(group.origin_terms)) return false;
    for (int a = 0; a < 3; ++a) lanes.centre[a][0] = group.centre[a];
    lanes.origin_terms[0] = group.origin_terms;
    lanes.weight_terms[0] = group.weight_terms;
    lanes.decision_doubt[0] = 1.001 * kDecisionDoubt * group.direction_terms;
    const bool placed = !wants_visible(scene);
    if (placed) state.mixed.resize(kLanes);
    if (state.rays.size() < kLanes) state.rays.resize(kLanes);
    state.rays_made.assign(state.vectors, 1);
    state.tile_of_vector.assign(state.vectors, 0);
    const std::uint32_t first = state.first_vector - group.first_vector;
    const bool last = &group == &scene.tiles->mixed.back();
    NarrowRays rays[kLanes];
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        prefetch_mixed(*scene.tiles, last ? nullptr : &group + 1, v);
        make_mixed_rays(scene, group, first + v, placed ? &state.mixed[v] : nullptr, state.rays[v]);
        rays[v] = invert_directions(state.rays[v]);
    }
    MixedFrame frame;
    if (!measure_rays(scene, group, state, rays, frame)) return false;
    put_mixed_planes(frame, state);
    return true;
}

/// What the samples of a mixed vector surely see.
HWY_NOINLINE void place_mixed(const KernelScene& scene, const MixedRays& rays, const Nearest& nearest,
                              Placed& placed) {
    const Words triangles = load_words(nearest.triangle);
    const std::uint32_t see = kAllLanes & ~bits(same(triangles, set_word(kNone)));
    if (!see) return place_none(placed);
    const Id some = nearest.triangle[std::countr_zero(see)];
    const bool all_one = bits(same(triangles, set_word(some))) == see;
    TriangleLanes one;
    if (all_one) one = broadcast_triangle(scene.data->triangles[some]);
    hn::Vec<IdTag> ids[kHalves];
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        const std::uint32_t own = see >> at & first_lanes(kDoubles);
        const Vector3 direction = load3(rays.direction, at);
        const RayLanes lanes{load3(rays.origin, at), direction, hn::Load(kDouble, rays.weight + at)};
        if (!all_one) one = gather_seen(*scene.data, nearest.triangle + at, own, some);
        store_part(place_own(one, load3(rays.centre, at), lanes, largest_part(direction), own), at, placed);
        ids[at / kDoubles] = ids_of(one, own);
    }
    store_words(join_ids(ids), placed.triangle);
}

/// Writes the hits of all samples of the group's vectors that `state` names.
HWY_NOINLINE void resolve_mixed(const KernelScene& scene, const MixedGroup& group, KernelState& state) {
    begin_doubts(state);
    const LaneFacets* facets =
        &scene.tiles->lanes[group.first_lanes + state.first_vector - group.first_vector];
    std::size_t next = 0;
    Placed placed;
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        if (v + kPlacedAhead < state.vectors) prefetch_triangles(scene, state.nearest[v + kPlacedAhead]);
        const auto facet_of = [&](std::size_t lane) HWY_ATTR -> const FacetRays& {
            return scene.tiles->rays[facets[v].rays[lane]];
        };
        place_mixed(scene, state.mixed[v], state.nearest[v], placed);
        finish_vector(scene, state, v, facet_of, next, placed);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
