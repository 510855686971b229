// Where samples' rays pass the triangles that they surely meet: what place() gives, bit for bit, in lanes.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_PLACE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_PLACE_INL_H
#undef TRILENS_KERNEL_PLACE_INL_H
#else
#define TRILENS_KERNEL_PLACE_INL_H
#endif

#include <algorithm>
#include <limits>

#include "projector/kernel_setup-inl.h"
#include "projector/place.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

// Every operation rounds as place() rounds it: no fused multiply-add.

HWY_INLINE Vector3 set3(const Vec3& v) {
    return {hn::Set(kDouble, v.x), hn::Set(kDouble, v.y), hn::Set(kDouble, v.z)};
}
HWY_INLINE Double exact_inner(const Vector3& a, const Vector3& b) {
    return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)), hn::Mul(a.z, b.z));
}
HWY_INLINE Vector3 exact_outer(const Vector3& a, const Vector3& b) {
    return {hn::Sub(hn::Mul(a.y, b.z), hn::Mul(b.y, a.z)), hn::Sub(hn::Mul(a.z, b.x), hn::Mul(b.z, a.x)),
            hn::Sub(hn::Mul(a.x, b.y), hn::Mul(b.x, a.y))};
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
    return {corner[0], e1, minus(corner[0], corner[2]), exact_outer(e1, e2),
            hn::Mul(largest_part(e1), largest_part(e2))};
}

/// The rays of some samples, as FacetRays::at gives them.
struct RayLanes {
    Vector3 origin, direction;
    Double weight;
};

HWY_INLINE Double linear_at(double c0, double c1, double c2, const Double& x, const Double& y) {
    return hn::Add(hn::Add(hn::Set(kDouble, c0), hn::Mul(x, hn::Set(kDouble, c1))),
                   hn::Mul(y, hn::Set(kDouble, c2)));
}
HWY_INLINE Vector3 linear_at(const std::array<Vec3, 3>& c, const Double& x, const Double& y) {
    return {linear_at(c[0].x, c[1].x, c[2].x, x, y), linear_at(c[0].y, c[1].y, c[2].y, x, y),
            linear_at(c[0].z, c[1].z, c[2].z, x, y)};
}

/// `x`, `y`: from FacetRays::screen.
HWY_INLINE RayLanes ray_lanes(const AffineRays& rays, const Double& x, const Double& y) {
    return {linear_at(rays.origin, x, y), linear_at(rays.direction, x, y),
            linear_at(rays.weight[0], rays.weight[1], rays.weight[2], x, y)};
}

/// `good`: lanes in which place() gives this value. It may give one in others too.
struct PlacedLanes {
    Double t, first, second, third;  // weights of the sorted corners
    hn::Mask<DoubleTag> good;
};

HWY_INLINE PlacedLanes place_lanes(const FrameLanes& f, const RayLanes& ray) {
    const Double one = hn::Set(kDouble, 1.0);
    const Vector3 from = minus(times(ray.weight, f.corner), ray.origin);
    const Double along = exact_inner(f.normal, ray.direction);
    const Vector3 turn = exact_outer(ray.direction, from);
    const Double scale = hn::Div(one, hn::Mul(ray.weight, along));
    PlacedLanes p;
    p.t = hn::Mul(exact_inner(f.normal, from), hn::Mul(ray.weight, scale));
    p.second = hn::Mul(exact_inner(f.turned, turn), scale);
    p.third = hn::Mul(exact_inner(f.e1, turn), scale);
    p.first = hn::Sub(hn::Sub(one, p.second), p.third);
    // More than its rounding, so that second + third is at most 1.
    const Double inside = hn::Set(kDouble, 0x1p-50);
    const Double infinity = hn::Set(kDouble, std::numeric_limits<double>::infinity());
    const Double trusted =
        hn::Mul(hn::Set(kDouble, kLeastDeterminant), hn::Mul(largest_part(ray.direction), f.size));
    const auto sound = hn::And(hn::Ge(hn::Abs(along), trusted), hn::Lt(hn::Abs(p.t), infinity));
    const Double least = hn::Min(p.first, hn::Min(p.second, p.third));
    p.good = hn::And(sound, hn::Gt(least, inside));
    return p;
}

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
struct TileSpots {
    float half[2], middle[2];  // of the rectangle, in lines of samples
    int first[2];              // line of the window
    int start[2];              // of the window, in pixels
    int side;                  // samples along a pixel's edge
    double screen[2];          // of the facet
};

HWY_INLINE TileSpots spots_of(const SampleGrid& grid, const FacetRays& facet, const SampleTile& tile) {
    const float x = static_cast<float>(tile.width - 1) / 2, y = static_cast<float>(tile.height - 1) / 2;
    return {{std::max(0.5f, x), std::max(0.5f, y)},
            {x, y},
            {tile.column, tile.row},
            {grid.x0, grid.y0},
            grid.side,
            {facet.screen.x, facet.screen.y}};
}

/// Offsets along axis a from `local` and the kDoubles - 1 after it.
HWY_INLINE Double offsets_of(const TileSpots& spots, int a, const float* local) {
    const hn::Rebind<float, DoubleTag> some;
    const auto line = hn::Round(
        hn::MulAdd(hn::Load(some, local), hn::Set(some, spots.half[a]), hn::Set(some, spots.middle[a])));
    const Double own = hn::PromoteTo(kDouble, line);
    const Double screen = hn::Set(kDouble, spots.screen[a]);
    // Whole numbers and halves: their sums are exact in any order.
    if (spots.side == 1)
        return hn::Sub(hn::Add(own, hn::Set(kDouble, spots.start[a] + spots.first[a] + 0.5)), screen);
    const Double in_window = hn::Add(own, hn::Set(kDouble, static_cast<double>(spots.first[a])));
    return hn::Sub(position_of_line(in_window, spots.start[a], spots.side), screen);
}

/// The rays of a vector's samples, from `at` on.
HWY_INLINE RayLanes rays_of(const TileSpots& spots, const FacetRays& facet, const SampleVector& vector,
                            std::size_t at) {
    return ray_lanes(facet.rays, offsets_of(spots, 0, vector.u + at), offsets_of(spots, 1, vector.v + at));
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
