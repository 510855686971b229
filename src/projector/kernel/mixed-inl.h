// Vectors whose samples have facets of their own: their rays, the beams around them, and what they surely
// see. Included once per instruction set.
#if defined(TRILENS_KERNEL_MIXED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_MIXED_INL_H
#undef TRILENS_KERNEL_MIXED_INL_H
#else
#define TRILENS_KERNEL_MIXED_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel/beams-inl.h"
#include "projector/kernel/leaf_rays-inl.h"
#include "projector/kernel/resolve-inl.h"
#include "projector/kernel/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// An axis and two directions across it, and what the group's rays do along them.
struct MixedFrame {
    float axis[3], side[2][3];
    float speed = 0, start = 0, behind = 0;  // most, most, least of the origins
    float error = 0;                         // of a height of unit normal
    // By vector: slopes of the directions to each side, and offsets of the planes that they make.
    alignas(64) float low[2][kLanes] = {}, high[2][kLanes] = {}, offset[4][kLanes] = {};
};

HWY_INLINE Floats dot(const float* a, const Floats (&b)[3]) {
    return multiply_add(set(a[0]), b[0], multiply_add(set(a[1]), b[1], set(a[2]) * b[2]));
}

/// False: directions do not have a middle.
HWY_INLINE bool set_axis(const Floats (&sum)[3], MixedFrame& frame) {
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
    return true;
}

/// Widens slopes and lowers offsets by what the slopes may be off.
HWY_INLINE void turn_planes(float least_cosine, MixedFrame& frame) {
    // With c the least cosine and u = 2^-24: slopes are off by 28 u / c^2, the planes' normals by 7 u / c.
    const float turn = 0x1p-18f / least_cosine;
    const float lower = turn * std::max(std::fabs(frame.start), std::fabs(frame.behind));
    for (int k = 0; k < 2; ++k) {
        store(load(frame.low[k]) - set(turn), frame.low[k]);
        store(load(frame.high[k]) + set(turn), frame.high[k]);
        for (float* offset : {frame.offset[2 * k], frame.offset[2 * k + 1]})
            store(load(offset) - set(lower), offset);
    }
}

/// Fills the frame from the rays of the group's vectors that `state` names. False: some ray goes too much
/// across the axis for planes.
HWY_NOINLINE bool measure_rays(const KernelScene& scene, const MixedGroup& group, const KernelState& state,
                               const NarrowRays* rays, MixedFrame& frame) {
    constexpr float kLeastCosineSquare = 0.01f;  // of the cosine to the axis
    Floats sum[3] = {set(0.0f), set(0.0f), set(0.0f)};
    for (std::uint32_t v = 0; v < state.group.vectors; ++v)
        for (int a = 0; a < 3; ++a) sum[a] = sum[a] + rays[v].direction[a];
    if (!set_axis(sum, frame)) return false;
    const Vec3 from = group.centre - scene.tree->centre, half = scene.tree->half;
    Floats cosine = set(1.0f), speed = set(0.0f), size = speed;
    Floats start = set(-kNever), behind = set(kNever);
    for (std::uint32_t v = 0; v < state.group.vectors; ++v) {
        const Floats(&d)[3] = rays[v].direction;
        const Floats(&own)[3] = rays[v].origin;
        const Floats along = dot(frame.axis, d), inverse = reciprocal(along);
        const Floats length = multiply_add(d[0], d[0], multiply_add(d[1], d[1], d[2] * d[2]));
        cosine = least(cosine, along * absolute(along) / length);
        speed = largest(speed, along);
        size = largest(size, absolute(own[0]) + absolute(own[1]) + absolute(own[2]));
        Floats o[3];
        for (int a = 0; a < 3; ++a) o[a] = own[a] + set(static_cast<float>(from[a]));
        const Floats ahead = dot(frame.axis, o);
        start = largest(start, ahead);
        behind = least(behind, ahead);
        for (int k = 0; k < 2; ++k) {
            const Floats slope = dot(frame.side[k], d) * inverse, beside = dot(frame.side[k], o);
            const float low = least_lane(slope), high = largest_lane(slope);
            frame.low[k][v] = low;
            frame.high[k][v] = high;
            frame.offset[2 * k][v] = least_lane(subtract_product(set(low), ahead, beside));
            frame.offset[2 * k + 1][v] = least_lane(multiply_subtract(set(high), ahead, beside));
        }
    }
    const float least_cosine = least_lane(cosine);
    frame.speed = largest_lane(speed);
    if (!(least_cosine > kLeastCosineSquare) || !std::isfinite(frame.speed)) return false;
    const double far = std::fabs(from.x) + std::fabs(from.y) + std::fabs(from.z);
    const double reach = half.x + half.y + half.z + 2 * far + static_cast<double>(largest_lane(size));
    frame.error = static_cast<float>(2 * kPlaneErrorBound * (reach + 1e-6 * group.origin_terms));
    frame.start = largest_lane(start);
    frame.behind = least_lane(behind);
    turn_planes(least_cosine, frame);
    return true;
}

/// Beams of the vectors and of their group. The planes' normals are not unit, but no shorter.
HWY_NOINLINE void put_mixed_planes(const MixedFrame& frame, KernelState& state) {
    const Floats error = set(frame.error), one = set(1.0f);
    state.work.beams.resize(1);
    VectorBeams& beams = state.work.beams[0];
    GroupBeam& beam = state.beam;
    beam.planes = 0;
    const auto add = [&](const float* side, float sign, float slope, float offset) HWY_ATTR {
        for (int a = 0; a < 3; ++a) beam.plane[beam.planes][a] = sign * (side[a] - slope * frame.axis[a]);
        beam.offset[beam.planes++] = offset - (1 + std::fabs(slope)) * frame.error;
    };
    for (int a = 0; a < 3; ++a) beam.axis[a] = beam.plane[0][a] = frame.axis[a];
    beam.offset[beam.planes++] = frame.behind - frame.error;
    for (int k = 0; k < 2; ++k) {
        const Floats low = load(frame.low[k]), high = load(frame.high[k]);
        for (int a = 0; a < 3; ++a) {
            const Floats axis = set(frame.axis[a]), side = set(frame.side[k][a]);
            store(subtract_product(low, axis, side), beams.plane[2 * k][a]);
            store(multiply_subtract(high, axis, side), beams.plane[2 * k + 1][a]);
        }
        store(subtract_product(error, one + absolute(low), load(frame.offset[2 * k])), beams.offset[2 * k]);
        store(subtract_product(error, one + absolute(high), load(frame.offset[2 * k + 1])),
              beams.offset[2 * k + 1]);
        // The group's normal is a vector's plus a share of the axis.
        const float least = *std::min_element(frame.low[k], frame.low[k] + state.group.vectors),
                    most = *std::max_element(frame.high[k], frame.high[k] + state.group.vectors);
        float from_low = kNever, from_high = kNever;
        for (std::uint32_t v = 0; v < state.group.vectors; ++v) {
            from_low = std::min(from_low, frame.offset[2 * k][v] + (frame.low[k][v] - least) * frame.behind);
            from_high =
                std::min(from_high, frame.offset[2 * k + 1][v] + (most - frame.high[k][v]) * frame.behind);
        }
        add(frame.side[k], 1, least, from_low - 0.25f * frame.error);
        add(frame.side[k], -1, most, from_high - 0.25f * frame.error);
    }
    beam.start = frame.start + frame.error;
    beam.speed_inverse = frame.speed > 0 ? (1 - 0x1p-16f) / frame.speed : 0;
    for (std::uint32_t v = 0; v < kLanes; ++v) beams.farthest[v] = v < state.group.vectors ? kNever : -kNever;
    state.work.beams_made = true;
}

// Vectors whose samples have facets of their own: their rays, facet by facet, and what they surely see.

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
    const TileSampleCoords window{
        {1, 1}, {0, 0}, {0, 0}, {grid.x0, grid.y0}, {grid.x0 + 0.5, grid.y0 + 0.5}, grid.side, {0, 0}, 0};
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
    lanes.decision_error[0] = 1.001 * kDecisionErrorBound * group.direction_terms;
    const bool placed = !wants_visible(scene);
    if (placed) state.work.mixed.resize(kLanes);
    if (state.work.rays.size() < kLanes) state.work.rays.resize(kLanes);
    state.work.rays_made.assign(state.group.vectors, 1);
    state.work.tile_of_vector.assign(state.group.vectors, 0);
    const std::uint32_t first = state.group.first_vector - group.first_vector;
    const bool last = &group == &scene.tiles->mixed.back();
    NarrowRays rays[kLanes];
    for (std::uint32_t v = 0; v < state.group.vectors; ++v) {
        prefetch_mixed(*scene.tiles, last ? nullptr : &group + 1, v);
        make_mixed_rays(scene, group, first + v, placed ? &state.work.mixed[v] : nullptr, state.work.rays[v]);
        rays[v] = invert_directions(state.work.rays[v]);
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
    begin_ambiguous(state);
    const LaneFacets* facets =
        &scene.tiles->lanes[group.first_lanes + state.group.first_vector - group.first_vector];
    std::size_t next = 0;
    Placed placed;
    for (std::uint32_t v = 0; v < state.group.vectors; ++v) {
        if (v + kPlacedAhead < state.group.vectors)
            prefetch_triangles(scene, state.seen.nearest[v + kPlacedAhead]);
        const auto facet_of = [&](std::size_t lane) HWY_ATTR -> const FacetRays& {
            return scene.tiles->rays[facets[v].rays[lane]];
        };
        place_mixed(scene, state.work.mixed[v], state.seen.nearest[v], placed);
        finish_vector(scene, state, v, facet_of, next, placed);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
