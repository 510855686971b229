// Sure hits of vectors: located in lanes, and written one hit per sample.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_WRITE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WRITE_INL_H
#undef TRILENS_KERNEL_WRITE_INL_H
#else
#define TRILENS_KERNEL_WRITE_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstddef>

#include "projector/kernel/hit_points-inl.h"
#include "projector/kernel/kernel.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

HWY_INLINE void set_lane(Placed& placed, std::size_t lane, const Hit& hit) {
    placed.triangle[lane] = hit.triangle;
    placed.t[lane] = hit.t;
    placed.second[lane] = hit.barycentric.x;
    placed.third[lane] = hit.barycentric.y;
}

/// Lane k alone.
HWY_INLINE void write_sample(const Placed& placed, std::size_t k, Hit& to) {
    to = {placed.triangle[k], placed.t[k], {placed.second[k], placed.third[k]}};
}

/// Lanes k and k + 1: each hit in two stores, so that few of them wait for the memory.
HWY_INLINE void write_two_samples(const Placed& placed, std::size_t k, Hit* const (&to)[2]) {
    static_assert(std::endian::native == std::endian::little);
    static_assert(sizeof(Hit) == 4 * sizeof(double) && offsetof(Hit, t) == sizeof(double) &&
                  offsetof(Hit, barycentric) == 2 * sizeof(double));
    const PairTag pair;
    const hn::Rebind<std::uint64_t, PairTag> word;
    const Pair id = hn::BitCast(pair, hn::PromoteTo(word, hn::LoadU(hn::Rebind<std::uint32_t, PairTag>(),
                                                                    placed.triangle + k))),
               t = hn::Load(pair, placed.t + k), second = hn::Load(pair, placed.second + k),
               third = hn::Load(pair, placed.third + k);
    double* const first[2] = {reinterpret_cast<double*>(to[0]), reinterpret_cast<double*>(to[1])};
    const auto put = [](const Pair& low, const Pair& high, double* at) HWY_ATTR {
#if HWY_MAX_BYTES >= 32
        const hn::FixedTag<double, 4> four;
        hn::StoreU(hn::Combine(four, high, low), four, at);
#else
        hn::StoreU(low, PairTag(), at);
        hn::StoreU(high, PairTag(), at + 2);
#endif
    };
    put(hn::InterleaveLower(pair, id, t), hn::InterleaveLower(pair, second, third), first[0]);
    put(hn::InterleaveUpper(pair, id, t), hn::InterleaveUpper(pair, second, third), first[1]);
}

/// What write_samples() will write of a vector.
HWY_INLINE void prefetch_hits(const KernelScene& scene, std::size_t vector) {
    const VectorSamples& samples = scene.tiles->samples[vector];
    for (std::size_t k = 0; k < kLanes; ++k) hwy::Prefetch(&scene.hits[samples.sample[k]]);
}

/// The hits of a vector's samples, in their places among all samples.
HWY_NOINLINE void write_samples(const KernelScene& scene, std::uint32_t vector, const Placed& placed) {
    constexpr std::size_t kAhead = 8;  // vectors, measured
    prefetch_hits(scene, std::min<std::size_t>(vector + kAhead, scene.tiles->samples.size() - 1));
    const VectorSamples& samples = scene.tiles->samples[vector];
    Hit* const hits = scene.hits.data();
    const std::size_t count = static_cast<std::size_t>(std::popcount(scene.tiles->valid[vector]));
    std::size_t k = 0;
    for (; k + 1 < count; k += 2)
        write_two_samples(placed, k, {hits + samples.sample[k], hits + samples.sample[k + 1]});
    if (k < count) write_sample(placed, k, hits[samples.sample[k]]);
}

/// A vector as floats: enough to tell which lanes are trusted.
struct PlacedFloats {
    Floats t, second, third;
    Words triangle;
};

HWY_INLINE PlacedFloats narrow(const Placed& placed) {
    return {narrow(load_doubles(placed.t)), narrow(load_doubles(placed.second)),
            narrow(load_doubles(placed.third)), load_words(placed.triangle)};
}

/// Lanes whose values hit_point() gives too: trusted, and inside by more than doubles and floats round.
HWY_INLINE Mask sound(const PlacedFloats& placed) {
    constexpr float kLeastInside = 1e-6f;
    const Floats least_weight =
        least(least(placed.second, placed.third), set(1.0f) - placed.second - placed.third);
    return (least_weight > set(kLeastInside)) & (absolute(placed.t) < set(kNever));
}

// What the samples of vectors surely see: placed in lanes.

/// Where the sure hits of a tile are placed.
struct TilePlacing {
    const KernelScene& scene;
    const FacetRays& facet;
    TileSampleCoords coords;
};

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

HWY_INLINE Double weight_of(const Double& second, const Double& third, std::size_t sorted_corner) {
    return sorted_corner == 0 ? first_weight(second, third) : sorted_corner == 1 ? second : third;
}

/// What a vector's samples see of one triangle.
struct PlacedVector {
    DoubleLanes t, second, third;
};

HWY_INLINE PlacedVector place_all(const TilePlacing& tile, const SampleVector& samples,
                                  const CachedFrame& cached) {
    static_assert(kHalves % 2 == 0);
    const Double largest = hn::Set(kDouble, tile.coords.largest), size = hn::Set(kDouble, cached.frame.size);
    PlacedVector placed;
    const auto put = [&](std::size_t i, const Double& t, const Double& along, const Double& second,
                         const Double& third) HWY_ATTR {
        placed.t.part[i] = trusted_time(t, along, largest, size);
        placed.second.part[i] = weight_of(second, third, cached.second);
        placed.third.part[i] = weight_of(second, third, cached.third);
    };
    for (std::size_t i = 0; i < kHalves; i += 2) {
        const PlacedOf<Two> p =
            place_lanes(broadcast(cached.frame), two_rays_of(tile.coords, tile.facet, samples, i * kDoubles));
        put(i, p.t.low, p.along.low, p.second.low, p.third.low);
        put(i + 1, p.t.high, p.along.high, p.second.high, p.third.high);
    }
    return placed;
}

HWY_INLINE PlacedFloats narrow(const PlacedVector& placed, Id triangle) {
    return {narrow(placed.t), narrow(placed.second), narrow(placed.third), set_word(triangle)};
}
HWY_INLINE void store_placed(const PlacedVector& from, Id triangle, Placed& placed) {
    store_doubles(from.t, placed.t);
    store_doubles(from.second, placed.second);
    store_doubles(from.third, placed.third);
    store_words(set_word(triangle), placed.triangle);
}

/// From lane `at` on.
HWY_INLINE void store_part(const PlacedPart& part, std::size_t at, Placed& placed) {
    hn::Store(part.t, kDouble, placed.t + at);
    hn::Store(part.second, kDouble, placed.second + at);
    hn::Store(part.third, kDouble, placed.third + at);
}

/// Nothing is seen.
HWY_INLINE void place_none(Placed& placed) {
    const Double zero = hn::Zero(kDouble);
    for (std::size_t at = 0; at < kLanes; at += kDoubles) store_part({zero, zero, zero}, at, placed);
    store_words(set_word(kNone), placed.triangle);
}

/// The samples of `see`: each its own triangle.
HWY_INLINE void place_each(const TilePlacing& tile, const SampleVector& samples, const Id* triangle,
                           std::uint32_t see, Placed& placed) {
    const Id some = triangle[std::countr_zero(see)];
    hn::Vec<IdTag> ids[kHalves];
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        const std::uint32_t own = see >> at & first_lanes(kDoubles);
        const TriangleLanes lanes = gather_seen(*tile.scene.data, triangle + at, own, some);
        store_part(place_own(lanes, set3(tile.facet.centre), rays_of(tile.coords, tile.facet, samples, at),
                             hn::Set(kDouble, tile.coords.largest), own),
                   at, placed);
        ids[at / kDoubles] = ids_of(lanes, own);
    }
    store_words(join_ids(ids), placed.triangle);
}

HWY_INLINE bool all_see_one(const Nearest& nearest) {
    const Id first = nearest.triangle[0];
    return first != kNone && bits(same(load_words(nearest.triangle), set_word(first))) == kAllLanes;
}

/// What the samples of a vector surely see, whatever they see.
HWY_NOINLINE void place_several(const TilePlacing& tile, const SampleVector& samples, const Nearest& nearest,
                                Placed& placed) {
    const std::uint32_t see = kAllLanes & ~bits(same(load_words(nearest.triangle), set_word(kNone)));
    if (!see) return place_none(placed);
    place_each(tile, samples, nearest.triangle, see, placed);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
