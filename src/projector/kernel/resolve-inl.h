// What each sample sees, with the bits that exact_hit() gives: sure hits in lanes, ambiguous ones one by one;
// and, where only that is asked for, the triangle and bounds of t. Included once per instruction set.
#if defined(TRILENS_KERNEL_RESOLVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_RESOLVE_INL_H
#undef TRILENS_KERNEL_RESOLVE_INL_H
#else
#define TRILENS_KERNEL_RESOLVE_INL_H
#endif

#include <algorithm>
#include <bit>

#include "base/util/check.h"
#include "projector/exact/exact_hit.h"
#include "projector/kernel/coverage-inl.h"
#include "projector/kernel/write-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

HWY_INLINE std::array<Vec3, 3> corners_of(const PreparedScene::Data& data, Id triangle, const Vec3& centre) {
    return {data.corner(0, triangle, centre), data.corner(1, triangle, centre),
            data.corner(2, triangle, centre)};
}

/// Where one sure hit lies, by the scalar decision, which must agree that it is one.
HWY_NOINLINE Hit locate_sure_hit(const KernelScene& scene, const FacetRays& facet, Id sample, Id triangle) {
    const std::optional<LineHit> hit =
        exact_hit(facet.at(scene.grid->position(sample)), corners_of(*scene.data, triangle, facet.centre));
    TRILENS_CHECK(hit.has_value(), "a sure hit must be one for the exact decision too");
    return scene_hit(*scene.data, triangle, *hit);
}

/// One sample among its sure hit, if any, and its ambiguous triangles, all decided exactly, by FirstHit's
/// rule.
HWY_NOINLINE Hit resolve_sample(const KernelScene& scene, const FacetRays& facet, Id sample, Id sure,
                                std::span<const AmbiguousHit> ambiguous) {
    const SampleRay ray = facet.at(scene.grid->position(sample));
    FirstHit first;
    const auto offer_all = [&] {
        Id last = kNone;
        const auto offer = [&](Id triangle) {
            const std::optional<LineHit> hit =
                exact_hit(ray, corners_of(*scene.data, triangle, facet.centre));
            if (hit) first.offer(*hit, triangle, scene.data->rank(triangle));
        };
        if (sure != kNone) offer(sure);
        for (const AmbiguousHit& one : ambiguous) {
            if (one.triangle != last && one.triangle != sure) offer(one.triangle);
            last = one.triangle;
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
HWY_NOINLINE void sort_ambiguous(std::vector<AmbiguousHit>& ambiguous) {
    std::sort(ambiguous.begin(), ambiguous.end(), [](const AmbiguousHit& a, const AmbiguousHit& b) {
        if (a.vector != b.vector) return a.vector < b.vector;
        return a.lane != b.lane ? a.lane < b.lane : a.triangle < b.triangle;
    });
}

/// Sorts the group's ambiguous hits, and counts their samples.
HWY_INLINE void begin_ambiguous(KernelState& state) {
    sort_ambiguous(state.seen.ambiguous);
    const AmbiguousHit* last = nullptr;
    for (const AmbiguousHit& one : state.seen.ambiguous) {
        state.seen.ambiguous_samples += !last || one.vector != last->vector || one.lane != last->lane;
        last = &one;
    }
}

/// Decides the ambiguous samples of a vector of the group, the next ones in the sorted list from `next` on,
/// and hands each lane's hit to `put`. `facet_of`: of a lane.
template <typename FacetOf, typename Put>
HWY_INLINE void resolve_ambiguous(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                                  const FacetOf& facet_of, std::size_t& next, const Put& put) {
    const std::vector<AmbiguousHit>& ambiguous = state.seen.ambiguous;
    while (next < ambiguous.size() && ambiguous[next].vector == in_group) {
        const std::size_t lane = ambiguous[next].lane;
        std::size_t end = next;
        while (end < ambiguous.size() && ambiguous[end].vector == in_group && ambiguous[end].lane == lane)
            ++end;
        const Id sample = scene.tiles->samples[state.group.first_vector + in_group].sample[lane];
        put(lane, resolve_sample(scene, facet_of(lane), sample, state.seen.nearest[in_group].triangle[lane],
                                 std::span(ambiguous).subspan(next, end - next)));
        next = end;
    }
}

/// Decides the lanes of `bad` one by one, by facet_of().
template <typename FacetOf>
HWY_INLINE void locate_lanes(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                             std::uint32_t bad, const FacetOf& facet_of, Placed& placed) {
    const VectorSamples& samples = scene.tiles->samples[state.group.first_vector + in_group];
    for (Each lane(bad); lane; ++lane)
        set_lane(placed, *lane,
                 locate_sure_hit(scene, facet_of(*lane), samples.sample[*lane],
                                 state.seen.nearest[in_group].triangle[*lane]));
}

/// Whether the ambiguous hits from `next` on begin with one of this vector.
HWY_INLINE bool is_ambiguous(const KernelState& state, std::size_t next, std::uint32_t in_group) {
    return next < state.seen.ambiguous.size() && state.seen.ambiguous[next].vector == in_group;
}

/// Writes a vector of the group: decides first what lanes could not.
template <typename FacetOf>
HWY_INLINE void finish_vector(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                              const FacetOf& facet_of, std::size_t& next, Placed& placed) {
    const PlacedFloats floats = narrow(placed);
    const std::uint32_t bad = kAllLanes & ~bits(sound(floats) | same(floats.triangle, set_word(kNone)));
    if (HWY_LIKELY(bad == 0 && !is_ambiguous(state, next, in_group)))
        return write_samples(scene, state.group.first_vector + in_group, placed);
    locate_lanes(scene, state, in_group, bad, facet_of, placed);
    resolve_ambiguous(scene, state, in_group, facet_of, next,
                      [&](std::size_t lane, const Hit& hit) HWY_ATTR { set_lane(placed, lane, hit); });
    write_samples(scene, state.group.first_vector + in_group, placed);
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
    const bool sure = bits(sound(floats)) == kAllLanes && !is_ambiguous(state, next, at.in_group);
    store_placed(one, cached.triangle, placed);
    if (HWY_LIKELY(sure)) write_samples(scene, at.vector, placed);
    return sure;
}

/// A vector of the covered tile of lane j.
HWY_INLINE void resolve_covered(const TilePlacing& placing, const TileVector& at, std::size_t j,
                                KernelState& state, std::size_t& next) {
    Placed placed;
    if (HWY_LIKELY(write_one(placing, at, state.seen.whole[j].triangle, state, next, placed))) return;
    touch_tile(placing.scene, j, state);
    finish_vector(
        placing.scene, state, at.in_group,
        [&](std::size_t) HWY_ATTR -> const FacetRays& { return placing.facet; }, next, placed);
}

/// A vector of another tile.
HWY_INLINE void resolve_vector(const TilePlacing& placing, const TileVector& at, KernelState& state,
                               std::size_t& next) {
    const Nearest& nearest = state.seen.nearest[at.in_group];
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
    const bool covered = state.seen.covered >> j & 1;
    const std::uint32_t first = tile.first_vector - state.group.first_vector;
    for (std::uint32_t i = first; i < first + tile.vectors; ++i) {
        const TileVector at{state.group.first_vector + i, i};
        if (covered) {
            resolve_covered(placing, at, j, state, next);
            continue;
        }
        if (i + kPlacedAhead < known) prefetch_triangles(placing.scene, state.seen.nearest[i + kPlacedAhead]);
        resolve_vector(placing, at, state, next);
    }
}

/// Writes the hits of all of the group's samples.
HWY_NOINLINE void resolve_group(const KernelScene& scene, KernelState& state) {
    begin_ambiguous(state);
    std::size_t next = 0;
    for (Each lane(state.seen.untouched & ~state.seen.covered); lane; ++lane)
        set_nearest(scene, *lane, state);
    for (std::uint32_t j = state.group.first_lane; j < state.group.first_lane + state.group.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
        const FacetRays& facet = scene.tiles->rays[tile.rays];
        if (state.cache.rays != tile.rays) {
            state.cache.triangle.fill(kNone);
            state.cache.rays = tile.rays;
        }
        const TilePlacing placing{scene, facet, sample_coords_of(*scene.grid, facet, tile, state.lanes, j)};
        const std::uint32_t end = tile.first_vector + tile.vectors - state.group.first_vector;
        resolve_tile(placing, tile, j, state.seen.covered ? end : state.group.vectors, state, next);
    }
}

// Writes results: the exact triangle and bounds of t of each sample; the place on the triangle comes later.

/// In the scene's order what `nearest` names in the prepared one.
HWY_INLINE Words scene_triangles(const PreparedScene::Data& data, const Nearest& nearest) {
    constexpr hn::RebindToSigned<WordTag> kIndex;
    static_assert(static_cast<std::int32_t>(kNone) == -1);  // where data.named has kNone
    Words triangles = load_words(nearest.triangle);
    for (std::size_t i = 0; i < kParts; ++i)
        triangles.part[i] =
            hn::GatherIndex(kWord, data.named.data() + 1, hn::BitCast(kIndex, triangles.part[i]));
    return triangles;
}

HWY_INLINE void write_samples(const KernelScene& scene, std::uint32_t vector, const VectorVisible& visible) {
    const VectorSamples& samples = scene.tiles->samples[vector];
    const std::size_t count = static_cast<std::size_t>(std::popcount(scene.tiles->valid[vector]));
    for (std::size_t k = 0; k < count; ++k)
        scene.visible[samples.sample[k]] = {visible.triangle[k], visible.t_low[k], visible.t_high[k]};
}

/// Of a vector of the group, whose sure hits are `nearest`: decides first what is ambiguous, and then
/// state.seen.nearest is set.
template <typename FacetOf>
HWY_INLINE void write_visible(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                              const Nearest& nearest, const FacetOf& facet_of, std::size_t& next) {
    const std::uint32_t vector = state.group.first_vector + in_group;
    const Words triangle = scene_triangles(*scene.data, nearest);
    const Floats low = load(nearest.low), high = load(nearest.high);
    const bool ambiguous = is_ambiguous(state, next, in_group);
    if (HWY_LIKELY(!ambiguous && scene.visible.empty())) {
        VectorVisible& out = scene.vector_visible[vector];
        stream_words(triangle, out.triangle);
        stream(low, out.t_low);
        stream(high, out.t_high);
        return;
    }
    VectorVisible own;
    store_words(triangle, own.triangle);
    store(low, own.t_low);
    store(high, own.t_high);
    if (ambiguous)
        resolve_ambiguous(scene, state, in_group, facet_of, next,
                          [&](std::size_t lane, const Hit& hit)
                              HWY_ATTR { set_lane(own, lane, visible_of(hit)); });
    if (!scene.vector_visible.empty()) scene.vector_visible[vector] = own;
    if (!scene.visible.empty()) write_samples(scene, vector, own);
}

/// The vectors of the tile of lane j.
HWY_INLINE void write_visible_tile(const KernelScene& scene, std::size_t j, KernelState& state,
                                   std::size_t& next) {
    const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
    const auto facet_of = [&](std::size_t)
                              HWY_ATTR -> const FacetRays& { return scene.tiles->rays[tile.rays]; };
    const std::uint32_t first = tile.first_vector - state.group.first_vector;
    Nearest whole;
    for (std::uint32_t i = first; i < first + tile.vectors; ++i) {
        if (is_ambiguous(state, next, i)) touch_tile(scene, j, state);
        if (state.seen.covered >> j & 1) {
            put_whole(state.seen.whole[j], tile, scene.tiles->vectors[state.group.first_vector + i], whole);
            write_visible(scene, state, i, whole, facet_of, next);
        } else {
            if (i + kPlacedAhead < state.group.vectors)
                prefetch_triangles(scene, state.seen.nearest[i + kPlacedAhead]);
            write_visible(scene, state, i, state.seen.nearest[i], facet_of, next);
        }
    }
}

/// What all of the group's samples see.
HWY_NOINLINE void write_visible_group(const KernelScene& scene, KernelState& state) {
    begin_ambiguous(state);
    std::size_t next = 0;
    for (Each lane(state.seen.untouched & ~state.seen.covered); lane; ++lane)
        set_nearest(scene, *lane, state);
    for (std::uint32_t j = state.group.first_lane; j < state.group.first_lane + state.group.tiles; ++j)
        write_visible_tile(scene, j, state, next);
}

/// All that pixels with kSeveral may see. `doubtful`: those, by vector of the group.
HWY_NOINLINE void list_open(const KernelScene& scene, const KernelState& state,
                            std::span<const std::uint32_t> doubtful) {
    if (state.seen.ambiguous.size() > state.seen.most_ambiguous) return;  // not all are listed
    const VectorSamples* const samples = &scene.tiles->samples[state.group.first_vector];
    const auto list = [&](std::uint32_t vector, std::uint32_t lane, Id triangle) {
        scene.open->push_back({samples[vector].sample[lane], scene.data->named[triangle + 1]});
    };
    for (std::uint32_t v = 0; v < state.group.vectors; ++v)
        for (Each lane(doubtful[v]); lane; ++lane) {
            const Id sure = state.seen.nearest[v].triangle[*lane];
            if (sure != kNone) list(v, *lane, sure);
        }
    for (const AmbiguousHit& one : state.seen.ambiguous)
        if (doubtful[one.vector] >> one.lane & 1) list(one.vector, one.lane, one.triangle);
}

/// What all of the group's pixels see: where nothing is in doubt that may be nearer.
HWY_NOINLINE void write_pixels_group(const KernelScene& scene, KernelState& state) {
    for (Each lane(state.seen.untouched); lane; ++lane) set_nearest(scene, *lane, state);
    std::vector<std::uint32_t>& doubts = state.work.pairs;
    doubts.resize(std::max<std::size_t>(doubts.size(), state.group.vectors));
    for (std::uint32_t i = 0; i < state.group.vectors; ++i) {
        const Nearest& nearest = state.seen.nearest[i];
        const Floats high = load(nearest.high), doubt = load(state.seen.doubts[i].low);
        const Mask doubtful = without(doubt < set(kNever), high < doubt);
        VectorVisible seen;
        store_words(choose(doubtful, set_word(kSeveral), scene_triangles(*scene.data, nearest)),
                    seen.triangle);
        store(load(nearest.low), seen.t_low);
        store(high, seen.t_high);
        write_samples(scene, state.group.first_vector + i, seen);
        doubts[i] = bits(doubtful) & scene.tiles->valid[state.group.first_vector + i];
    }
    if (scene.open) list_open(scene, state, std::span(doubts).first(state.group.vectors));
}

/// What all samples of the mixed group's vectors that `state` names see.
HWY_NOINLINE void write_visible_mixed(const KernelScene& scene, const MixedGroup& group, KernelState& state) {
    begin_ambiguous(state);
    const LaneFacets* facets =
        &scene.tiles->lanes[group.first_lanes + state.group.first_vector - group.first_vector];
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < state.group.vectors; ++v) {
        const auto facet_of = [&](std::size_t lane) HWY_ATTR -> const FacetRays& {
            return scene.tiles->rays[facets[v].rays[lane]];
        };
        write_visible(scene, state, v, state.seen.nearest[v], facet_of, next);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
