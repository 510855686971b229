// What the samples of vectors surely see: placed in lanes.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_PLACED_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_PLACED_INL_H
#undef TRILENS_KERNEL_PLACED_INL_H
#else
#define TRILENS_KERNEL_PLACED_INL_H
#endif

#include "projector/kernel/kernel_spots-inl.h"
#include "projector/kernel/kernel_write-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// Where the sure hits of a tile are placed.
struct TilePlacing {
    const KernelScene& scene;
    const FacetRays& facet;
    TileSpots spots;
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
    const Double largest = hn::Set(kDouble, tile.spots.largest), size = hn::Set(kDouble, cached.frame.size);
    PlacedVector placed;
    const auto put = [&](std::size_t i, const Double& t, const Double& along, const Double& second,
                         const Double& third) HWY_ATTR {
        placed.t.part[i] = trusted_time(t, along, largest, size);
        placed.second.part[i] = weight_of(second, third, cached.second);
        placed.third.part[i] = weight_of(second, third, cached.third);
    };
    for (std::size_t i = 0; i < kHalves; i += 2) {
        const PlacedOf<Two> p =
            place_lanes(broadcast(cached.frame), two_rays_of(tile.spots, tile.facet, samples, i * kDoubles));
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
        store_part(place_own(lanes, set3(tile.facet.centre), rays_of(tile.spots, tile.facet, samples, at),
                             hn::Set(kDouble, tile.spots.largest), own),
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
