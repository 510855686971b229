// What each sample sees, with the bits that decide() gives: sure hits in lanes, doubtful ones one by one.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_RESOLVE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_RESOLVE_INL_H
#undef TRILENS_KERNEL_RESOLVE_INL_H
#else
#define TRILENS_KERNEL_RESOLVE_INL_H
#endif

#include <algorithm>

#include "base/check.h"
#include "projector/kernel_place-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

using NameTag = hn::Rebind<std::uint64_t, DoubleTag>;
using IdTag = hn::Rebind<std::uint32_t, DoubleTag>;
inline constexpr NameTag kName;
inline constexpr IdTag kId;

/// What a vector's samples see, in the terms of the scene's triangles.
struct alignas(64) Placed {
    double t[kLanes], second[kLanes], third[kLanes];
    std::uint64_t name[kLanes];  // the lower half: index into the scene, or kNone
};

HWY_INLINE void set_lane(Placed& placed, std::size_t lane, const Hit& hit) {
    placed.name[lane] = hit.triangle;
    placed.t[lane] = hit.t;
    placed.second[lane] = hit.barycentric.x;
    placed.third[lane] = hit.barycentric.y;
}

HWY_INLINE Words triangles_of(const Placed& placed) {
    Words r;
    for (std::size_t i = 0; i < kParts; ++i) {
        const auto low = hn::Load(kName, placed.name + i * kPart),
                   high = hn::Load(kName, placed.name + i * kPart + kDoubles);
        r.part[i] = hn::Combine(kWord, hn::TruncateTo(kId, high), hn::TruncateTo(kId, low));
    }
    return r;
}

HWY_NOINLINE void write_hits(const KernelScene& scene, std::uint32_t vector, const Placed& placed) {
    if (!scene.vector_hits.empty()) {
        // Past the caches: nobody here reads it again.
        VectorHits& out = scene.vector_hits[vector];
        stream_words(triangles_of(placed), out.triangle);
        stream(narrow(load_doubles(placed.t)), out.t);
        stream(narrow(load_doubles(placed.second)), out.u);
        stream(narrow(load_doubles(placed.third)), out.v);
    }
    if (scene.hits.empty()) return;
    const VectorSamples& samples = scene.tiles->samples[vector];
    for (Each lane(samples.valid); lane; ++lane) {
        const std::size_t k = *lane;
        scene.hits[samples.sample[k]] = {
            static_cast<Id>(placed.name[k]), placed.t[k], {placed.second[k], placed.third[k]}};
    }
}

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

HWY_NOINLINE void fill_frame(const PreparedTriangle& triangle, const Vec3& centre, CachedFrame& to) {
    to.frame = triangle_frame(
        {triangle.corner[0] - centre, triangle.corner[1] - centre, triangle.corner[2] - centre});
    to.triangle = triangle.triangle();
    to.second = static_cast<std::uint8_t>(triangle.second());
    to.third = static_cast<std::uint8_t>(triangle.third());
}

HWY_INLINE const CachedFrame& cached_frame(const KernelScene& scene, const Vec3& centre, Id triangle,
                                           FrameCache& cache) {
    const std::size_t at = triangle % kCachedFrames;
    if (cache.triangle[at] != triangle) {
        fill_frame(scene.data->triangles[triangle], centre, cache.frame[at]);
        cache.triangle[at] = triangle;
    }
    return cache.frame[at];
}

HWY_INLINE const Double& weight_of(const PlacedLanes& p, std::size_t sorted_corner) {
    return sorted_corner == 0 ? p.first : sorted_corner == 1 ? p.second : p.third;
}

HWY_INLINE std::uint32_t bits(const hn::Mask<DoubleTag>& mask) {
    std::uint8_t bytes[8] = {};
    hn::StoreMaskBits(kDouble, mask, bytes);
    return bytes[0];
}

HWY_INLINE hn::Mask<DoubleTag> mask_of_doubles(std::uint32_t lanes) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(lanes)};
    return hn::LoadMaskBits(kDouble, bytes);
}

using PairTag = hn::FixedTag<double, 2>;
using Pair = hn::Vec<PairTag>;
inline constexpr std::size_t kPairs = kDoubles / 2;

/// Pairs side by side.
template <typename Tag>
HWY_INLINE hn::Vec<Tag> join(Tag tag, const Pair* pair) {
    if constexpr (hn::MaxLanes(Tag()) == 2) {
        return pair[0];
    } else {
        const hn::Half<Tag> half;
        return hn::Combine(tag, join(half, pair + hn::MaxLanes(half) / 2), join(half, pair));
    }
}

/// PreparedTriangles, one per lane: as numbers, 9 of corners and the name.
struct TriangleLanes {
    Double number[10];
};

HWY_INLINE TriangleLanes gather_triangles(const PreparedTriangle* const (&from)[kDoubles]) {
    static_assert(sizeof(PreparedTriangle) == 10 * sizeof(double));
    const PairTag pair_tag;
    TriangleLanes triangles;
    for (std::size_t n = 0; n < 10; n += 2) {
        Pair even[kPairs], odd[kPairs];
        for (std::size_t i = 0; i < kPairs; ++i) {
            const Pair a = hn::LoadU(pair_tag, reinterpret_cast<const double*>(from[2 * i]) + n),
                       b = hn::LoadU(pair_tag, reinterpret_cast<const double*>(from[2 * i + 1]) + n);
            even[i] = hn::InterleaveLower(pair_tag, a, b);
            odd[i] = hn::InterleaveUpper(pair_tag, a, b);
        }
        triangles.number[n] = join(kDouble, even);
        triangles.number[n + 1] = join(kDouble, odd);
    }
    return triangles;
}

/// The same triangle in every lane.
HWY_INLINE TriangleLanes broadcast_triangle(const PreparedTriangle& triangle) {
    TriangleLanes lanes;
    for (std::size_t c = 0; c < 3; ++c) {
        for (int a = 0; a < 3; ++a)
            lanes.number[3 * c + static_cast<std::size_t>(a)] = hn::Set(kDouble, triangle.corner[c][a]);
    }
    lanes.number[9] = hn::BitCast(kDouble, hn::Set(kName, triangle.name));
    return lanes;
}

/// Where the sure hits of a tile are placed.
struct TilePlacing {
    const KernelScene& scene;
    const FacetRays& facet;
    TileSpots spots;
};

/// From lane `at` on: each of `lanes` its own triangle, the others nothing. `centre`: of the facets. Returns
/// those where place() says nothing.
HWY_INLINE std::uint32_t place_own(const TriangleLanes& own, const Vector3& centre, const RayLanes& rays,
                                   std::uint32_t lanes, std::size_t at, Placed& placed) {
    Vector3 corner[3];
    for (std::size_t c = 0; c < 3; ++c)
        corner[c] = minus({own.number[3 * c], own.number[3 * c + 1], own.number[3 * c + 2]}, centre);
    const PlacedLanes p = place_lanes(frame_lanes(corner), rays);
    const auto name = hn::BitCast(kName, own.number[9]);
    const auto weight = [&](int bit) HWY_ATTR {
        const auto is_second = hn::TestBit(name, hn::Set(kName, std::uint64_t{1} << bit));
        const auto is_third = hn::TestBit(name, hn::Set(kName, std::uint64_t{2} << bit));
        return hn::IfThenElse(hn::RebindMask(kDouble, is_second), p.second,
                              hn::IfThenElse(hn::RebindMask(kDouble, is_third), p.third, p.first));
    };
    const auto mask = mask_of_doubles(lanes);
    hn::Store(hn::IfThenElseZero(mask, p.t), kDouble, placed.t + at);
    hn::Store(hn::IfThenElseZero(mask, weight(PreparedTriangle::kSecondBit)), kDouble, placed.second + at);
    hn::Store(hn::IfThenElseZero(mask, weight(PreparedTriangle::kThirdBit)), kDouble, placed.third + at);
    hn::Store(hn::IfThenElse(hn::RebindMask(kName, mask), name, hn::Set(kName, std::uint64_t{kNone})), kName,
              placed.name + at);
    return lanes & ~bits(p.good);
}

/// From lane `at` on: each of `lanes` its own triangle, the others nothing. `centre`: of the facets. Returns
/// those where place() says nothing.
HWY_INLINE std::uint32_t place_each(const PreparedScene::Data& data, const Vector3& centre,
                                    const RayLanes& rays, const Id* triangle, std::uint32_t lanes,
                                    std::size_t at, Placed& placed) {
    const PreparedTriangle* from[kDoubles];
    const PreparedTriangle* all = data.triangles.data();
    const Id some = triangle[std::countr_zero(lanes)];
    for (std::size_t k = 0; k < kDoubles; ++k) from[k] = all + (lanes >> k & 1 ? triangle[k] : some);
    return place_own(gather_triangles(from), centre, rays, lanes, at, placed);
}

/// From lane `at` on: all see one triangle. Returns as place_each().
HWY_INLINE std::uint32_t place_all(const CachedFrame& cached, const RayLanes& rays, std::size_t at,
                                   Placed& placed) {
    const PlacedLanes p = place_lanes(broadcast(cached.frame), rays);
    hn::Store(p.t, kDouble, placed.t + at);
    hn::Store(weight_of(p, cached.second), kDouble, placed.second + at);
    hn::Store(weight_of(p, cached.third), kDouble, placed.third + at);
    hn::Store(hn::Set(kName, std::uint64_t{cached.triangle}), kName, placed.name + at);
    return first_lanes(kDoubles) & ~bits(p.good);
}

/// What the samples of a vector surely see.
HWY_NOINLINE void place_sure_hits(const TilePlacing& tile, std::uint32_t vector, const Nearest& nearest,
                                  FrameCache& cache, Placed& placed) {
    const KernelScene& scene = tile.scene;
    const SampleVector& samples = scene.tiles->vectors[vector];
    const Words triangles = load_words(nearest.triangle);
    const Id first = nearest.triangle[0];
    std::uint32_t bad = 0;
    if (first != kNone && bits(same(triangles, set_word(first))) == kAllLanes) {
        const CachedFrame& cached = cached_frame(scene, tile.facet.centre, first, cache);
        for (std::size_t at = 0; at < kLanes; at += kDoubles)
            bad |= place_all(cached, rays_of(tile.spots, tile.facet, samples, at), at, placed) << at;
    } else {
        const std::uint32_t see = kAllLanes & ~bits(same(triangles, set_word(kNone)));
        for (std::size_t at = 0; at < kLanes; at += kDoubles) {
            const std::uint32_t own = see >> at & first_lanes(kDoubles);
            if (own) {
                bad |= place_each(*scene.data, set3(tile.facet.centre),
                                  rays_of(tile.spots, tile.facet, samples, at), nearest.triangle + at, own,
                                  at, placed)
                       << at;
            } else {
                for (std::size_t k = at; k < at + kDoubles; ++k) set_lane(placed, k, Hit{});
            }
        }
    }
    for (Each lane(bad); lane; ++lane)
        set_lane(placed, *lane,
                 decide_sure(scene, tile.facet, scene.tiles->samples[vector].sample[*lane],
                             nearest.triangle[*lane]));
}

/// One sample among its sure hit, if any, and its doubtful triangles, all decided exactly, by FirstHits'
/// rule.
HWY_NOINLINE Hit resolve_sample(const KernelScene& scene, const FacetRays& facet, Id sample, Id sure,
                                std::span<const Doubt> doubts) {
    const SampleRay ray = facet.at(scene.grid->position(sample));
    FirstHits hits(1);
    const auto offer_all = [&] {
        Id last = kNone;
        const auto offer = [&](Id triangle) {
            const std::optional<LineHit> hit = decide(ray, corners_of(*scene.data, triangle, facet.centre));
            if (hit) hits.offer(0, *hit, triangle, scene.data->rank[triangle]);
        };
        if (sure != kNone) offer(sure);
        for (const Doubt& doubt : doubts) {
            if (doubt.triangle != last && doubt.triangle != sure) offer(doubt.triangle);
            last = doubt.triangle;
        }
    };
    offer_all();
    if (hits.order_mattered()) hits.begin_second_pass(), offer_all();
    const Id winner = hits.winner(0);
    return winner == kNone ? Hit{} : scene_hit(*scene.data, winner, hits.hit(0));
}

/// What place_sure_hits() reads of the scene. Each lane's, without asking which are the same: that would take
/// longer.
HWY_INLINE void prefetch_triangles(const KernelScene& scene, const Nearest& nearest) {
    if (scene.data->triangles.empty()) return;
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

/// Decides the doubtful samples of a vector of the group, the next ones in the sorted list from `next` on.
/// `facet_of`: of a lane.
template <typename FacetOf>
HWY_INLINE void resolve_doubts(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                               const FacetOf& facet_of, std::size_t& next, Placed& placed) {
    const std::vector<Doubt>& doubts = state.doubts;
    while (next < doubts.size() && doubts[next].vector == in_group) {
        const std::size_t lane = doubts[next].lane;
        std::size_t end = next;
        while (end < doubts.size() && doubts[end].vector == in_group && doubts[end].lane == lane) ++end;
        set_lane(placed, lane,
                 resolve_sample(
                     scene, facet_of(lane), scene.tiles->samples[state.first_vector + in_group].sample[lane],
                     state.nearest[in_group].triangle[lane], std::span(doubts).subspan(next, end - next)));
        next = end;
    }
}

inline constexpr std::uint32_t kPlacedAhead = 3;  // vectors whose triangles are fetched meanwhile

/// Writes the hits of all of the group's samples.
HWY_NOINLINE void resolve_group(const KernelScene& scene, KernelState& state) {
    sort_doubts(state.doubts);
    std::size_t next = 0;
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
        const FacetRays& facet = scene.tiles->rays[tile.rays];
        if (state.cache.rays != tile.rays) {
            state.cache.triangle.fill(kNone);
            state.cache.rays = tile.rays;
        }
        const TilePlacing placing{scene, facet, spots_of(*scene.grid, facet, tile)};
        Placed placed;
        for (std::uint32_t i = 0; i < tile.vectors; ++i) {
            const std::uint32_t vector = tile.first_vector + i, in_group = vector - state.first_vector;
            const Nearest& nearest = state.nearest[in_group];
            if (in_group + kPlacedAhead < state.vectors)
                prefetch_triangles(scene, state.nearest[in_group + kPlacedAhead]);
            place_sure_hits(placing, vector, nearest, state.cache, placed);
            resolve_doubts(
                scene, state, in_group, [&](std::size_t) -> const FacetRays& { return facet; }, next, placed);
            write_hits(scene, vector, placed);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
