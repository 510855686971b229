// Where a tile's samples lie on its facet's screen, and their rays, in lanes.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_SPOTS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_SPOTS_INL_H
#undef TRILENS_KERNEL_SPOTS_INL_H
#else
#define TRILENS_KERNEL_SPOTS_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel/kernel_place-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

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
    double first[2];           // line of the window
    int start[2];              // of the window, in pixels
    double shift[2];           // of a line's middle in pixels, where each pixel is one sample
    int side;                  // samples along a pixel's edge
    double screen[2];          // of the facet
    double largest;            // coordinate of a ray's direction, or more
};

/// No coordinate of a direction of the rays of lane j's tile is larger, as place() computes it.
HWY_INLINE double largest_direction(const TileLanes& lanes, std::size_t j) {
    const double scaled =
        std::max(lanes.direction_sum[0][j], std::max(lanes.direction_sum[1][j], lanes.direction_sum[2][j]));
    return 1.0001 * lanes.weight_high[j] * scaled;
}

HWY_INLINE TileSpots spots_of(const SampleGrid& grid, const FacetRays& facet, const SampleTile& tile,
                              const TileLanes& lanes, std::size_t j) {
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

/// The lines of samples that kDoubles local coordinates are nearest to; `half`, `middle` as TileSpots'.
HWY_INLINE Double lines_at(const float* local, float half, float middle) {
    const hn::Rebind<float, DoubleTag> some;
    return hn::PromoteTo(
        kDouble, hn::Round(hn::MulAdd(hn::Load(some, local), hn::Set(some, half), hn::Set(some, middle))));
}

/// Offsets along axis a from `local` and the kDoubles - 1 after it.
HWY_INLINE Double offsets_of(const TileSpots& spots, int a, const float* local) {
    const Double own = lines_at(local, spots.half[a], spots.middle[a]);
    const Double screen = hn::Set(kDouble, spots.screen[a]);
    // Whole numbers and halves: their sums are exact in any order.
    if (spots.side == 1) return hn::Sub(hn::Add(own, hn::Set(kDouble, spots.shift[a])), screen);
    const Double in_window = hn::Add(own, hn::Set(kDouble, spots.first[a]));
    return hn::Sub(position_of_line(in_window, spots.start[a], spots.side), screen);
}

/// The rays of a vector's samples, from `at` on.
HWY_INLINE RayLanes rays_of(const TileSpots& spots, const FacetRays& facet, const SampleVector& vector,
                            std::size_t at) {
    return ray_lanes(facet.rays, offsets_of(spots, 0, vector.u + at), offsets_of(spots, 1, vector.v + at));
}
HWY_INLINE RaysOf<Two> two_rays_of(const TileSpots& spots, const FacetRays& facet, const SampleVector& vector,
                                   std::size_t at) {
    const auto both = [&](int a, const float* local) HWY_ATTR {
        return Two{offsets_of(spots, a, local + at), offsets_of(spots, a, local + at + kDoubles)};
    };
    return ray_lanes(facet.rays, both(0, vector.u), both(1, vector.v));
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
