// Where samples' rays meet the triangles that they surely see, in lanes: what hit_point() gives, bit for bit.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_HIT_POINTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_HIT_POINTS_INL_H
#undef TRILENS_KERNEL_HIT_POINTS_INL_H
#else
#define TRILENS_KERNEL_HIT_POINTS_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "projector/exact/exact_hit.h"
#include "projector/kernel/setup-inl.h"
#include "projector/scene/bvh.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

// Every operation rounds as hit_point() rounds it: no fused multiply-add.

HWY_INLINE Vector3 set3(const Vec3& v) {
    return {hn::Set(kDouble, v.x), hn::Set(kDouble, v.y), hn::Set(kDouble, v.z)};
}
template <typename A, typename B>
HWY_INLINE A exact_dot(const VectorOf<A>& a, const VectorOf<B>& b) {
    return plus(plus(product(a.x, b.x), product(a.y, b.y)), product(a.z, b.z));
}
template <typename A>
HWY_INLINE VectorOf<A> exact_cross(const VectorOf<A>& a, const VectorOf<A>& b) {
    return {minus(product(a.y, b.z), product(b.y, a.z)), minus(product(a.z, b.x), product(b.z, a.x)),
            minus(product(a.x, b.y), product(b.x, a.y))};
}
HWY_INLINE Double largest_part(const Vector3& v) {
    return hn::Max(hn::Abs(v.x), hn::Max(hn::Abs(v.y), hn::Abs(v.z)));
}

/// TriangleFrame, one triangle per lane.
struct FrameLanes {
    Vector3 corner, e1, turned, normal;
    Double size;
};

HWY_INLINE FrameLanes broadcast(const TriangleFrame& frame) {
    return {set3(frame.corner), set3(frame.e1), set3(frame.turned), set3(frame.normal),
            hn::Set(kDouble, frame.size)};
}

/// triangle_frame() in lanes.
HWY_INLINE FrameLanes frame_lanes(const Vector3 (&corner)[3]) {
    const Vector3 e1 = minus(corner[1], corner[0]), e2 = minus(corner[2], corner[0]);
    return {corner[0], e1, minus(corner[0], corner[2]), exact_cross(e1, e2),
            hn::Mul(largest_part(e1), largest_part(e2))};
}

/// The rays of some samples, as FacetRays::at gives them.
template <typename Number>
struct RaysOf {
    VectorOf<Number> origin, direction;
    Number weight;
};
using RayLanes = RaysOf<Double>;

template <typename Number>
HWY_INLINE Number linear_at(double c0, double c1, double c2, const Number& x, const Number& y) {
    return plus(plus(product(x, hn::Set(kDouble, c1)), hn::Set(kDouble, c0)),
                product(y, hn::Set(kDouble, c2)));
}
template <typename Number>
HWY_INLINE VectorOf<Number> linear_at(const std::array<Vec3, 3>& c, const Number& x, const Number& y) {
    return {linear_at(c[0].x, c[1].x, c[2].x, x, y), linear_at(c[0].y, c[1].y, c[2].y, x, y),
            linear_at(c[0].z, c[1].z, c[2].z, x, y)};
}

/// `x`, `y`: from FacetRays::screen.
template <typename Number>
HWY_INLINE RaysOf<Number> ray_lanes(const AffineRays& rays, const Number& x, const Number& y) {
    return {linear_at(rays.origin, x, y), linear_at(rays.direction, x, y),
            linear_at(rays.weight[0], rays.weight[1], rays.weight[2], x, y)};
}

/// What hit_point() says, without its questions.
template <typename Number>
struct PlacedOf {
    Number t, second, third;  // weights of the sorted corners
    Number along;
};

template <typename Number>
HWY_INLINE PlacedOf<Number> place_lanes(const FrameLanes& f, const RaysOf<Number>& ray) {
    const VectorOf<Number> from = minus(times(ray.weight, f.corner), ray.origin);
    const Number along = exact_dot(ray.direction, f.normal);
    const VectorOf<Number> turn = exact_cross(ray.direction, from);
    const Number scale = inverse(product(ray.weight, along));
    return {product(exact_dot(from, f.normal), product(ray.weight, scale)),
            product(exact_dot(turn, f.turned), scale), product(exact_dot(turn, f.e1), scale), along};
}

/// `t` where hit_point() trusts `along`, else not a number. `largest`: coordinate of the ray's direction, or
/// more.
HWY_INLINE Double trusted_time(const Double& t, const Double& along, const Double& largest,
                               const Double& size) {
    const Double least = hn::Mul(hn::Set(kDouble, kLeastDeterminant), hn::Mul(largest, size));
    const Double unknown = hn::Set(kDouble, std::numeric_limits<double>::quiet_NaN());
    return hn::IfThenElse(hn::Ge(hn::Abs(along), least), t, unknown);
}

/// The weight of the first sorted corner.
HWY_INLINE Double first_weight(const Double& second, const Double& third) {
    return hn::Sub(hn::Sub(hn::Set(kDouble, 1.0), second), third);
}

// Samples that see different triangles: those gathered lane by lane, and where each is met.

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

// Where a tile's samples lie on its facet's screen, and their rays, in lanes.

/// SampleGrid::position along one axis, from lines of samples counted from the window's corner.
HWY_INLINE Double position_of_line(const Double& line, int start, int side) {
    const Double half = hn::Set(kDouble, 0.5), from = hn::Set(kDouble, static_cast<double>(start));
    if (side == 1) return hn::Add(hn::Add(from, line), half);
    const Double n = hn::Set(kDouble, static_cast<double>(side));
    const Double pixel = hn::Floor(hn::Div(hn::Add(line, half), n));
    const Double inside = hn::Sub(line, hn::Mul(pixel, n));
    return hn::Add(hn::Add(from, pixel), hn::Div(hn::Add(inside, half), n));
}

/// From a tile's local coordinates to offsets from its facet's screen.
struct TileSampleCoords {
    float half[2], middle[2];  // of the rectangle, in lines of samples
    double first[2];           // line of the window
    int start[2];              // of the window, in pixels
    double shift[2];           // of a line's middle in pixels, where each pixel is one sample
    int side;                  // samples along a pixel's edge
    double screen[2];          // of the facet
    double largest;            // coordinate of a ray's direction, or more
};

/// No coordinate of a direction of the rays of lane j's tile is larger, as hit_point() computes it.
HWY_INLINE double largest_direction(const TileLanes& lanes, std::size_t j) {
    const double scaled =
        std::max(lanes.direction_sum[0][j], std::max(lanes.direction_sum[1][j], lanes.direction_sum[2][j]));
    return 1.0001 * lanes.weight_high[j] * scaled;
}

HWY_INLINE TileSampleCoords sample_coords_of(const SampleGrid& grid, const FacetRays& facet,
                                             const SampleTile& tile, const TileLanes& lanes, std::size_t j) {
    const float x = static_cast<float>(tile.width - 1) / 2, y = static_cast<float>(tile.height - 1) / 2;
    return {{std::max(0.5f, x), std::max(0.5f, y)},
            {x, y},
            {static_cast<double>(tile.column), static_cast<double>(tile.row)},
            {grid.x0, grid.y0},
            {grid.x0 + tile.column + 0.5, grid.y0 + tile.row + 0.5},
            grid.side,
            {facet.screen.x, facet.screen.y},
            largest_direction(lanes, j)};
}

/// The lines of samples that kDoubles local coordinates are nearest to; `half`, `middle` as
/// TileSampleCoords'.
HWY_INLINE Double lines_at(const float* local, float half, float middle) {
    const hn::Rebind<float, DoubleTag> some;
    return hn::PromoteTo(
        kDouble, hn::Round(hn::MulAdd(hn::Load(some, local), hn::Set(some, half), hn::Set(some, middle))));
}

/// Offsets along axis a from `local` and the kDoubles - 1 after it.
HWY_INLINE Double offsets_of(const TileSampleCoords& coords, int a, const float* local) {
    const Double own = lines_at(local, coords.half[a], coords.middle[a]);
    const Double screen = hn::Set(kDouble, coords.screen[a]);
    // Whole numbers and halves: their sums are exact in any order.
    if (coords.side == 1) return hn::Sub(hn::Add(own, hn::Set(kDouble, coords.shift[a])), screen);
    const Double in_window = hn::Add(own, hn::Set(kDouble, coords.first[a]));
    return hn::Sub(position_of_line(in_window, coords.start[a], coords.side), screen);
}

/// The rays of a vector's samples, from `at` on.
HWY_INLINE RayLanes rays_of(const TileSampleCoords& coords, const FacetRays& facet,
                            const SampleVector& vector, std::size_t at) {
    return ray_lanes(facet.rays, offsets_of(coords, 0, vector.u + at), offsets_of(coords, 1, vector.v + at));
}
HWY_INLINE RaysOf<Two> two_rays_of(const TileSampleCoords& coords, const FacetRays& facet,
                                   const SampleVector& vector, std::size_t at) {
    const auto both = [&](int a, const float* local) HWY_ATTR {
        return Two{offsets_of(coords, a, local + at), offsets_of(coords, a, local + at + kDoubles)};
    };
    return ray_lanes(facet.rays, both(0, vector.u), both(1, vector.v));
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
