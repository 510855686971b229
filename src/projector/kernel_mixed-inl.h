// Vectors whose samples have facets of their own: their rays one run of lanes after the other, beams around
// them, and what they surely see. Included once per instruction set.
#if defined(TRILENS_KERNEL_MIXED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_MIXED_INL_H
#undef TRILENS_KERNEL_MIXED_INL_H
#else
#define TRILENS_KERNEL_MIXED_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel_resolve-inl.h"
#include "projector/kernel_walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// A vector's rays, with the bits of FacetRays::at.
HWY_NOINLINE void make_mixed_rays(const KernelScene& scene, std::uint32_t vector, const LaneFacets& facets,
                                  MixedRays& rays) {
    const SampleVector& samples = scene.tiles->vectors[vector];
    const SampleGrid& grid = *scene.grid;
    const TileSpots window{{1, 1},    {0, 0}, {0, 0}, {grid.x0, grid.y0}, {grid.x0 + 0.5, grid.y0 + 0.5},
                           grid.side, {0, 0}, 0};
    Double x[kHalves], y[kHalves];
    for (std::size_t i = 0; i < kHalves; ++i) {
        x[i] = offsets_of(window, 0, samples.u + i * kDoubles);
        y[i] = offsets_of(window, 1, samples.v + i * kDoubles);
    }
    const Words ids = load_words(facets.rays);
    for (std::uint32_t left = kAllLanes; left != 0;) {
        const Id id = facets.rays[std::countr_zero(left)];
        const std::uint32_t own = bits(same(ids, set_word(id)));
        left &= ~own;
        const FacetRays& facet = scene.tiles->rays[id];
        for (std::size_t i = 0; i < kHalves; ++i) {
            const std::size_t at = i * kDoubles;
            const std::uint32_t lanes = own >> at & first_lanes(kDoubles);
            if (!lanes) continue;
            const RayLanes r = ray_lanes(facet.rays, hn::Sub(x[i], hn::Set(kDouble, facet.screen.x)),
                                         hn::Sub(y[i], hn::Set(kDouble, facet.screen.y)));
            const auto mask = mask_of_doubles(lanes);
            const auto put = [&](const Vector3& v, double(*to)[kLanes]) HWY_ATTR {
                hn::BlendedStore(v.x, mask, kDouble, to[0] + at);
                hn::BlendedStore(v.y, mask, kDouble, to[1] + at);
                hn::BlendedStore(v.z, mask, kDouble, to[2] + at);
            };
            put(r.origin, rays.origin);
            put(r.direction, rays.direction);
            put(set3(facet.centre), rays.centre);
            hn::BlendedStore(r.weight, mask, kDouble, rays.weight + at);
        }
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

/// Divides the weight out and measures origins from `centre`.
HWY_NOINLINE void divide_rays(const MixedRays& rays, const Vec3& centre, VectorRays& to) {
    const Vector3 from = set3(centre);
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        const Double inverse = hn::Div(hn::Set(kDouble, 1.0), hn::Load(kDouble, rays.weight + at));
        const Vector3 origin =
            plus(times(inverse, load3(rays.origin, at)), minus(load3(rays.centre, at), from));
        const Vector3 direction = times(inverse, load3(rays.direction, at));
        const auto put = [&](const Vector3& v, double(*into)[kLanes]) HWY_ATTR {
            hn::Store(v.x, kDouble, into[0] + at);
            hn::Store(v.y, kDouble, into[1] + at);
            hn::Store(v.z, kDouble, into[2] + at);
        };
        put(origin, to.origin);
        put(direction, to.direction);
    }
    invert_directions(to);
}

/// An axis and two directions across it, and what the group's rays do along them.
struct MixedFrame {
    float axis[3], side[2][3];
    float speed = 0, start = 0, behind = 0;  // most, most, least of the origins
    float turn = 0;                          // by how much slopes are widened
    float doubt = 0;                         // of a height of unit normal
    // By vector: slopes of the directions to each side, and offsets of the planes that they make.
    alignas(64) float low[2][kLanes], high[2][kLanes], offset[4][kLanes];
};

HWY_INLINE Floats inner(const float* a, const Floats (&b)[3]) {
    return multiply_add(set(a[0]), b[0], multiply_add(set(a[1]), b[1], set(a[2]) * b[2]));
}
HWY_INLINE void load_narrow(const double (*from)[kLanes], Floats (&to)[3]) {
    for (int a = 0; a < 3; ++a) to[a] = narrow(load_doubles(from[a]));
}

/// Fills low, high and speed. False: some ray goes too much across the axis for planes.
HWY_NOINLINE bool measure_slopes(const KernelState& state, MixedFrame& frame) {
    constexpr float kLeastSquare = 0.01f;  // of the cosine to the axis
    Floats sum[3] = {set(0.0f), set(0.0f), set(0.0f)};
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        Floats d[3];
        load_narrow(state.rays[v].direction, d);
        for (int a = 0; a < 3; ++a) sum[a] = sum[a] + d[a];
    }
    double axis[3], across[2][3], square = 0;
    for (int a = 0; a < 3; ++a) {
        axis[a] = sum_of_lanes(sum[a]);
        square += axis[a] * axis[a];
    }
    if (!(square > 1e-30) || !std::isfinite(square)) return false;
    for (double& a : axis) a /= std::sqrt(square);
    directions_across(axis, across);
    for (int a = 0; a < 3; ++a) {
        frame.axis[a] = static_cast<float>(axis[a]);
        for (int k = 0; k < 2; ++k) frame.side[k][a] = static_cast<float>(across[k][a]);
    }
    Floats cosine = set(1.0f), speed = set(0.0f);
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        Floats d[3];
        load_narrow(state.rays[v].direction, d);
        const Floats along = inner(frame.axis, d), inverse = set(1.0f) / along;
        const Floats length = multiply_add(d[0], d[0], multiply_add(d[1], d[1], d[2] * d[2]));
        cosine = least(cosine, along * absolute(along) / length);
        speed = largest(speed, along);
        for (int k = 0; k < 2; ++k) {
            const Floats slope = inner(frame.side[k], d) * inverse;
            frame.low[k][v] = least_lane(slope);
            frame.high[k][v] = largest_lane(slope);
        }
    }
    const float least_cosine = least_lane(cosine);
    frame.speed = largest_lane(speed);
    if (!(least_cosine > kLeastSquare) || !std::isfinite(frame.speed)) return false;
    // With c the least cosine and u = 2^-24: slopes are off by 24 u / c^2, the planes' normals by 7 u / c.
    frame.turn = 0x1p-18f / least_cosine;
    return true;
}

/// Fills the offsets, start and behind.
HWY_NOINLINE void measure_offsets(const KernelScene& scene, const MixedGroup& group, const KernelState& state,
                                  MixedFrame& frame) {
    const Vec3 from = group.centre - scene.tree->centre, half = scene.tree->half;
    Floats start = set(-kNever), behind = set(kNever), size = set(0.0f);
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        Floats o[3];
        load_narrow(state.rays[v].origin, o);
        size = largest(size, absolute(o[0]) + absolute(o[1]) + absolute(o[2]));
        for (int a = 0; a < 3; ++a) o[a] = o[a] + set(static_cast<float>(from[a]));
        const Floats ahead = inner(frame.axis, o);
        start = largest(start, ahead);
        behind = least(behind, ahead);
        for (int k = 0; k < 2; ++k) {
            const Floats beside = inner(frame.side[k], o);
            frame.low[k][v] -= frame.turn;
            frame.high[k][v] += frame.turn;
            frame.offset[2 * k][v] = least_lane(subtract_product(set(frame.low[k][v]), ahead, beside));
            frame.offset[2 * k + 1][v] = least_lane(multiply_subtract(set(frame.high[k][v]), ahead, beside));
        }
    }
    const double far = std::fabs(from.x) + std::fabs(from.y) + std::fabs(from.z);
    const double reach = half.x + half.y + half.z + 2 * far + static_cast<double>(largest_lane(size));
    frame.doubt = static_cast<float>(2 * kPlaneDoubt * (reach + 1e-6 * group.origin_terms));
    frame.start = largest_lane(start);
    frame.behind = least_lane(behind);
}

/// Beams of the vectors and of their group. The planes' normals are not unit, but no shorter.
HWY_NOINLINE void put_mixed_planes(const MixedFrame& frame, KernelState& state) {
    const Floats doubt = set(frame.doubt), one = set(1.0f);
    state.beams.resize(1);
    VectorBeams& beams = state.beams[0];
    GroupBeam& beam = state.beam;
    beam.planes = 0;
    const auto add = [&](const float* side, float sign, float slope, float offset) HWY_ATTR {
        for (int a = 0; a < 3; ++a) beam.plane[beam.planes][a] = sign * (side[a] - slope * frame.axis[a]);
        beam.offset[beam.planes++] = offset - (1 + std::fabs(slope)) * frame.doubt;
    };
    for (int a = 0; a < 3; ++a) beam.axis[a] = beam.plane[0][a] = frame.axis[a];
    beam.offset[beam.planes++] = frame.behind - frame.doubt;
    for (int k = 0; k < 2; ++k) {
        const Floats low = load(frame.low[k]), high = load(frame.high[k]);
        for (int a = 0; a < 3; ++a) {
            const Floats axis = set(frame.axis[a]), side = set(frame.side[k][a]);
            store(subtract_product(low, axis, side), beams.plane[2 * k][a]);
            store(multiply_subtract(high, axis, side), beams.plane[2 * k + 1][a]);
        }
        store(subtract_product(doubt, one + absolute(low), load(frame.offset[2 * k])), beams.offset[2 * k]);
        store(subtract_product(doubt, one + absolute(high), load(frame.offset[2 * k + 1])),
              beams.offset[2 * k + 1]);
        // The group's normal is a vector's plus a share of the axis.
        const float least = *std::min_element(frame.low[k], frame.low[k] + state.vectors),
                    most = *std::max_element(frame.high[k], frame.high[k] + state.vectors);
        float from_low = kNever, from_high = kNever;
        for (std::uint32_t v = 0; v < state.vectors; ++v) {
            from_low = std::min(from_low, frame.offset[2 * k][v] + (frame.low[k][v] - least) * frame.behind);
            from_high =
                std::min(from_high, frame.offset[2 * k + 1][v] + (most - frame.high[k][v]) * frame.behind);
        }
        add(frame.side[k], 1, least, from_low - 0.25f * frame.doubt);
        add(frame.side[k], -1, most, from_high - 0.25f * frame.doubt);
    }
    beam.start = frame.start + frame.doubt;
    beam.speed_inverse = frame.speed > 0 ? (1 - 0x1p-16f) / frame.speed : 0;
    for (std::uint32_t v = 0; v < kLanes; ++v) beams.farthest[v] = v < state.vectors ? kNever : -kNever;
    state.beams_made = true;
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
    state.mixed.resize(kLanes);
    if (state.rays.size() < kLanes) state.rays.resize(kLanes);
    state.rays_made.assign(state.vectors, 1);
    state.tile_of_vector.assign(state.vectors, 0);
    const LaneFacets* facets =
        &scene.tiles->lanes[group.first_lanes + state.first_vector - group.first_vector];
    const bool last = &group == &scene.tiles->mixed.back();
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        prefetch_mixed(*scene.tiles, last ? nullptr : &group + 1, v);
        make_mixed_rays(scene, state.first_vector + v, facets[v], state.mixed[v]);
    }
    for (std::uint32_t v = 0; v < state.vectors; ++v)
        divide_rays(state.mixed[v], group.centre, state.rays[v]);
    MixedFrame frame{};
    if (!measure_slopes(state, frame)) return false;
    measure_offsets(scene, group, state, frame);
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
    sort_doubts(state.doubts);
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
