// What each sample sees, with the bits that decide() gives: sure hits in lanes, doubtful ones one by one.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_RESOLVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_RESOLVE_INL_H
#undef TRILENS_KERNEL_RESOLVE_INL_H
#else
#define TRILENS_KERNEL_RESOLVE_INL_H
#endif

#include <algorithm>

#include "base/util/check.h"
#include "projector/exact/first_hit.h"
#include "projector/kernel/kernel_placed-inl.h"
#include "projector/kernel/kernel_whole-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

HWY_INLINE std::array<Vec3, 3> corners_of(const PreparedScene::Data& data, Id triangle, const Vec3& centre) {
    return {data.corner(0, triangle, centre), data.corner(1, triangle, centre),
            data.corner(2, triangle, centre)};
}

/// Where one sure hit lies, by the scalar decision, which must agree that it is one.
HWY_NOINLINE Hit decide_sure(const KernelScene& scene, const FacetRays& facet, Id sample, Id triangle) {
    const std::optional<LineHit> hit =
        decide(facet.at(scene.grid->position(sample)), corners_of(*scene.data, triangle, facet.centre));
    TRILENS_CHECK(hit.has_value(), "a sure hit must be one for the exact decision too");
    return scene_hit(*scene.data, triangle, *hit);
}

/// One sample among its sure hit, if any, and its doubtful triangles, all decided exactly, by FirstHit's
/// rule.
HWY_NOINLINE Hit resolve_sample(const KernelScene& scene, const FacetRays& facet, Id sample, Id sure,
                                std::span<const Doubt> doubts) {
    const SampleRay ray = facet.at(scene.grid->position(sample));
    FirstHit first;
    const auto offer_all = [&] {
        Id last = kNone;
        const auto offer = [&](Id triangle) {
            const std::optional<LineHit> hit = decide(ray, corners_of(*scene.data, triangle, facet.centre));
            if (hit) first.offer(*hit, triangle, scene.data->rank(triangle));
        };
        if (sure != kNone) offer(sure);
        for (const Doubt& doubt : doubts) {
            if (doubt.triangle != last && doubt.triangle != sure) offer(doubt.triangle);
            last = doubt.triangle;
        }
    };
    offer_all();
    if (first.order_mattered()) first.begin_second_pass(), offer_all();
    return first.winner() == kNone ? Hit{} : scene_hit(*scene.data, first.winner(), first.hit());
}

/// What place_sure_hits() reads of the scene. Each lane's, without asking which are the same: that would take
/// longer.
HWY_INLINE void prefetch_triangles(const KernelScene& scene, const Nearest& nearest) {
    constexpr std::size_t kCached = 4000;  // measured: so many triangles are in a cache anyway
    if (scene.data->triangles.size() < kCached) return;
    const Id first = nearest.triangle[0];
    const bool whole = bits(same(load_words(nearest.triangle), set_word(first))) == kAllLanes;
    for (std::size_t k = 0; k < (whole ? 1 : kLanes); ++k) {
        const Id triangle = nearest.triangle[k] == kNone ? 0 : nearest.triangle[k];
        const char* from = reinterpret_cast<const char*>(scene.data->triangles.data() + triangle);
        hwy::Prefetch(from);
        hwy::Prefetch(from + sizeof(PreparedTriangle) - 1);
    }
}

/// By vector, lane and triangle.
HWY_NOINLINE void sort_doubts(std::vector<Doubt>& doubts) {
    std::sort(doubts.begin(), doubts.end(), [](const Doubt& a, const Doubt& b) {
        if (a.vector != b.vector) return a.vector < b.vector;
        return a.lane != b.lane ? a.lane < b.lane : a.triangle < b.triangle;
    });
}

/// Sorts the group's doubts, and counts their samples.
HWY_INLINE void begin_doubts(KernelState& state) {
    sort_doubts(state.doubts);
    const Doubt* last = nullptr;
    for (const Doubt& doubt : state.doubts) {
        state.doubtful += !last || doubt.vector != last->vector || doubt.lane != last->lane;
        last = &doubt;
    }
}

/// Decides the doubtful samples of a vector of the group, the next ones in the sorted list from `next` on,
/// and hands each lane's hit to `put`. `facet_of`: of a lane.
template <typename FacetOf, typename Put>
HWY_INLINE void resolve_doubts(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                               const FacetOf& facet_of, std::size_t& next, const Put& put) {
    const std::vector<Doubt>& doubts = state.doubts;
    while (next < doubts.size() && doubts[next].vector == in_group) {
        const std::size_t lane = doubts[next].lane;
        std::size_t end = next;
        while (end < doubts.size() && doubts[end].vector == in_group && doubts[end].lane == lane) ++end;
        const Id sample = scene.tiles->samples[state.first_vector + in_group].sample[lane];
        put(lane, resolve_sample(scene, facet_of(lane), sample, state.nearest[in_group].triangle[lane],
                                 std::span(doubts).subspan(next, end - next)));
        next = end;
    }
}

/// Decides the lanes of `bad` one by one, by facet_of().
template <typename FacetOf>
HWY_INLINE void decide_lanes(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                             std::uint32_t bad, const FacetOf& facet_of, Placed& placed) {
    const VectorSamples& samples = scene.tiles->samples[state.first_vector + in_group];
    for (Each lane(bad); lane; ++lane)
        set_lane(placed, *lane,
                 decide_sure(scene, facet_of(*lane), samples.sample[*lane],
                             state.nearest[in_group].triangle[*lane]));
}

/// Whether the doubts from `next` on begin with one of this vector.
HWY_INLINE bool is_doubtful(const KernelState& state, std::size_t next, std::uint32_t in_group) {
    return next < state.doubts.size() && state.doubts[next].vector == in_group;
}

/// Writes a vector of the group: decides first what lanes could not.
template <typename FacetOf>
HWY_INLINE void finish_vector(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                              const FacetOf& facet_of, std::size_t& next, Placed& placed) {
    const PlacedFloats floats = narrow(placed);
    const std::uint32_t bad = kAllLanes & ~bits(sound(floats) | same(floats.triangle, set_word(kNone)));
    if (HWY_LIKELY(bad == 0 && !is_doubtful(state, next, in_group)))
        return write_samples(scene, state.first_vector + in_group, placed);
    decide_lanes(scene, state, in_group, bad, facet_of, placed);
    resolve_doubts(scene, state, in_group, facet_of, next,
                   [&](std::size_t lane, const Hit& hit) HWY_ATTR { set_lane(placed, lane, hit); });
    write_samples(scene, state.first_vector + in_group, placed);
}

inline constexpr std::uint32_t kPlacedAhead = 3;  // vectors whose triangles are fetched meanwhile

/// The next vector of a tile.
struct TileVector {
    std::uint32_t vector, in_group;
};

/// Writes a vector all of whose samples surely see `triangle`. False: that needs a closer look, and `placed`
/// says what is known.
HWY_INLINE bool write_one(const TilePlacing& tile, const TileVector& at, Id triangle, KernelState& state,
                          std::size_t next, Placed& placed) {
    const KernelScene& scene = tile.scene;
    const CachedFrame& cached = cached_frame(scene, tile.facet.centre, triangle, state.cache);
    const PlacedVector one = place_all(tile, scene.tiles->vectors[at.vector], cached);
    const PlacedFloats floats = narrow(one, cached.triangle);
    const bool sure = bits(sound(floats)) == kAllLanes && !is_doubtful(state, next, at.in_group);
    store_placed(one, cached.triangle, placed);
    if (HWY_LIKELY(sure)) write_samples(scene, at.vector, placed);
    return sure;
}

/// A vector of the covered tile of lane j.
HWY_INLINE void resolve_covered(const TilePlacing& placing, const TileVector& at, std::size_t j,
                                KernelState& state, std::size_t& next) {
    Placed placed;
    if (HWY_LIKELY(write_one(placing, at, state.whole[j].triangle, state, next, placed))) return;
    touch_tile(placing.scene, j, state);
    finish_vector(
        placing.scene, state, at.in_group,
        [&](std::size_t) HWY_ATTR -> const FacetRays& { return placing.facet; }, next, placed);
}

/// A vector of another tile.
HWY_INLINE void resolve_vector(const TilePlacing& placing, const TileVector& at, KernelState& state,
                               std::size_t& next) {
    const Nearest& nearest = state.nearest[at.in_group];
    Placed placed;
    if (all_see_one(nearest)) {
        if (write_one(placing, at, nearest.triangle[0], state, next, placed)) return;
    } else {
        place_several(placing, placing.scene.tiles->vectors[at.vector], nearest, placed);
    }
    finish_vector(
        placing.scene, state, at.in_group,
        [&](std::size_t) HWY_ATTR -> const FacetRays& { return placing.facet; }, next, placed);
}

/// The tile of lane j, whose vectors from `known` on are not set.
HWY_INLINE void resolve_tile(const TilePlacing& placing, const SampleTile& tile, std::size_t j,
                             std::uint32_t known, KernelState& state, std::size_t& next) {
    const bool covered = state.covered >> j & 1;
    const std::uint32_t first = tile.first_vector - state.first_vector;
    for (std::uint32_t i = first; i < first + tile.vectors; ++i) {
        const TileVector at{state.first_vector + i, i};
        if (covered) {
            resolve_covered(placing, at, j, state, next);
            continue;
        }
        if (i + kPlacedAhead < known) prefetch_triangles(placing.scene, state.nearest[i + kPlacedAhead]);
        resolve_vector(placing, at, state, next);
    }
}

/// Writes the hits of all of the group's samples.
HWY_NOINLINE void resolve_group(const KernelScene& scene, KernelState& state) {
    begin_doubts(state);
    std::size_t next = 0;
    for (Each lane(state.untouched & ~state.covered); lane; ++lane) set_nearest(scene, *lane, state);
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
        const FacetRays& facet = scene.tiles->rays[tile.rays];
        if (state.cache.rays != tile.rays) {
            state.cache.triangle.fill(kNone);
            state.cache.rays = tile.rays;
        }
        const TilePlacing placing{scene, facet, spots_of(*scene.grid, facet, tile, state.lanes, j)};
        const std::uint32_t end = tile.first_vector + tile.vectors - state.first_vector;
        resolve_tile(placing, tile, j, state.covered ? end : state.vectors, state, next);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
