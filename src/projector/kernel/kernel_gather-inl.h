// Samples that see different triangles: those gathered lane by lane, and where each is met.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_GATHER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_GATHER_INL_H
#undef TRILENS_KERNEL_GATHER_INL_H
#else
#define TRILENS_KERNEL_GATHER_INL_H
#endif

#include <bit>

#include "projector/kernel/kernel_place-inl.h"
#include "projector/scene/prepared_data.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

using NameTag = hn::Rebind<std::uint64_t, DoubleTag>;
using IdTag = hn::Rebind<std::uint32_t, DoubleTag>;
inline constexpr NameTag kName;
inline constexpr IdTag kId;

HWY_INLINE hn::Mask<DoubleTag> mask_of_doubles(std::uint32_t lanes) {
    const std::uint8_t bytes[8] = {static_cast<std::uint8_t>(lanes)};
    return hn::LoadMaskBits(kDouble, bytes);
}

using PairTag = hn::FixedTag<double, 2>;
using Pair = hn::Vec<PairTag>;
inline constexpr std::size_t kPairs = kDoubles / 2;

/// From each of kPairs triangles, `step` apart, two of its numbers: pairs side by side. Loads that repeat a
/// pair and blends take no part in the machine's one unit that moves lanes.
HWY_INLINE Double load_pairs(const PreparedTriangle* const* from, std::size_t step, std::size_t number) {
    const auto load = [&](std::size_t i) HWY_ATTR {
        return hn::LoadDup128(kDouble, reinterpret_cast<const double*>(from[i * step]) + number);
    };
    Double pairs = load(0);
    for (std::size_t i = 1; i < kPairs; ++i)
        pairs = hn::IfThenElse(mask_of_doubles(3u << 2 * i), load(i), pairs);
    return pairs;
}

/// PreparedTriangles, one per lane: as numbers, 9 of corners and the name.
struct TriangleLanes {
    Double number[10];
};

HWY_INLINE TriangleLanes gather_triangles(const PreparedTriangle* const (&from)[kDoubles]) {
    static_assert(sizeof(PreparedTriangle) == 10 * sizeof(double));
    TriangleLanes triangles;
    for (std::size_t n = 0; n < 10; n += 2) {
        const Double even = load_pairs(from, 2, n), odd = load_pairs(from + 1, 2, n);
        triangles.number[n] = hn::InterleaveLower(kDouble, even, odd);
        triangles.number[n + 1] = hn::InterleaveUpper(kDouble, even, odd);
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

/// What a vector's samples see, in the terms of the scene's triangles.
struct alignas(64) Placed {
    double t[kLanes], second[kLanes], third[kLanes];
    Id triangle[kLanes];  // index into the scene, or kNone
};

/// Some samples' of it.
struct PlacedPart {
    Double t, second, third;
};

/// Each of `lanes` its own triangle, the others nothing. `centre`: of the facets.
/// `largest`: coordinate of the rays' directions, or more.
HWY_INLINE PlacedPart place_own(const TriangleLanes& own, const Vector3& centre, const RayLanes& rays,
                                const Double& largest, std::uint32_t lanes) {
    Vector3 corner[3];
    for (std::size_t c = 0; c < 3; ++c)
        corner[c] = minus(Vector3{own.number[3 * c], own.number[3 * c + 1], own.number[3 * c + 2]}, centre);
    const FrameLanes frame = frame_lanes(corner);
    const PlacedOf<Double> p = place_lanes(frame, rays);
    const Double first = first_weight(p.second, p.third);
    const auto name = hn::BitCast(kName, own.number[9]);
    const auto weight = [&](int bit) HWY_ATTR {
        const auto is_second = hn::TestBit(name, hn::Set(kName, std::uint64_t{1} << bit));
        const auto is_third = hn::TestBit(name, hn::Set(kName, std::uint64_t{2} << bit));
        return hn::IfThenElse(hn::RebindMask(kDouble, is_second), p.second,
                              hn::IfThenElse(hn::RebindMask(kDouble, is_third), p.third, first));
    };
    const auto mask = mask_of_doubles(lanes);
    return {hn::IfThenElseZero(mask, trusted_time(p.t, p.along, largest, frame.size)),
            hn::IfThenElseZero(mask, weight(PreparedTriangle::kSecondBit)),
            hn::IfThenElseZero(mask, weight(PreparedTriangle::kThirdBit))};
}

/// Indices into the scene of the triangles of `lanes`; the others' kNone.
HWY_INLINE hn::Vec<IdTag> ids_of(const TriangleLanes& own, std::uint32_t lanes) {
    const auto mask = hn::RebindMask(kName, mask_of_doubles(lanes));
    return hn::TruncateTo(
        kId, hn::IfThenElse(mask, hn::BitCast(kName, own.number[9]), hn::Set(kName, std::uint64_t{kNone})));
}

/// The lanes' own triangles; lanes that see nothing have `some`.
HWY_INLINE TriangleLanes gather_seen(const PreparedScene::Data& data, const Id* triangle, std::uint32_t lanes,
                                     Id some) {
    const PreparedTriangle* from[kDoubles];
    const PreparedTriangle* all = data.triangles.data();
    for (std::size_t k = 0; k < kDoubles; ++k) from[k] = all + (lanes >> k & 1 ? triangle[k] : some);
    return gather_triangles(from);
}

/// Side by side.
HWY_INLINE Words join_ids(const hn::Vec<IdTag> (&part)[kHalves]) {
    Words r;
    for (std::size_t i = 0; i < kParts; ++i) r.part[i] = hn::Combine(kWord, part[2 * i + 1], part[2 * i]);
    return r;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
