// Frusta for culling: planes around all rays of a group of tiles, and around single vectors of samples.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_BEAMS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_BEAMS_INL_H
#undef TRILENS_KERNEL_BEAMS_INL_H
#else
#define TRILENS_KERNEL_BEAMS_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "projector/kernel/kernel.h"
#include "projector/kernel/setup-inl.h"
#include "projector/kernel/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// The corner rays of a group's tiles, in lanes of kDoubles; origins from the tree's centre. The last ones
/// may repeat.
struct HullRays {
    alignas(64) double origin[3][4 * kLanes], direction[3][4 * kLanes], shortness[4 * kLanes];
    std::size_t count = 0;
    double size = 0;  // largest origin in the 1-norm, and the tree's
};

HWY_INLINE double least_of(const Double& v) {
    return hn::GetLane(hn::MinOfLanes(kDouble, v));
}
HWY_INLINE double largest_of(const Double& v) {
    return hn::GetLane(hn::MaxOfLanes(kDouble, v));
}
HWY_INLINE double sum_of(const Double& v) {
    return hn::GetLane(hn::SumOfLanes(kDouble, v));
}
HWY_INLINE Vector3 load_ray(const double (*from)[4 * kLanes], std::size_t at) {
    return {hn::Load(kDouble, from[0] + at), hn::Load(kDouble, from[1] + at),
            hn::Load(kDouble, from[2] + at)};
}
HWY_INLINE Vector3 set_vector(const double* v) {
    return {hn::Set(kDouble, v[0]), hn::Set(kDouble, v[1]), hn::Set(kDouble, v[2])};
}

HWY_NOINLINE void gather_hulls(const KernelScene& scene, const KernelState& state, HullRays& rays) {
    const Vec3& centre = scene.tree->centre;
    const TileFrusta& hull = state.lanes.hull;
    const std::size_t first = state.group.first_lane, tiles = state.group.tiles;
    for (int a = 0; a < 3; ++a) {
        for (std::size_t k = 0; k < 4; ++k) {
            for (std::size_t j = 0; j < tiles; ++j) {
                rays.origin[a][k * tiles + j] =
                    hull.origin[k][a][first + j] + (hull.centre[a][first + j] - centre[a]);
                rays.direction[a][k * tiles + j] = hull.direction[k][a][first + j];
            }
        }
        for (std::size_t i = 4 * tiles; i % kDoubles != 0; ++i) {
            rays.origin[a][i] = rays.origin[a][4 * tiles - 1];
            rays.direction[a][i] = rays.direction[a][4 * tiles - 1];
        }
    }
    rays.count = (4 * tiles + kDoubles - 1) / kDoubles * kDoubles;
    // Both terms of the sum above, each at most this in the 1-norm.
    double far = 0, terms = 0;
    for (std::size_t j = first; j < first + tiles; ++j) {
        double from_tree = 1e-6 * state.lanes.origin_terms[j];
        for (int a = 0; a < 3; ++a) from_tree += std::fabs(hull.centre[a][j] - centre[a]);
        far = std::max(far, from_tree);
    }
    Double largest_origin = hn::Zero(kDouble);
    for (std::size_t at = 0; at < rays.count; at += kDoubles) {
        const Vector3 o = absolute(load_ray(rays.origin, at));
        largest_origin = hn::Max(largest_origin, hn::Add(o.x, hn::Add(o.y, o.z)));
    }
    terms = largest_of(largest_origin) + 2 * far;
    rays.size = terms + scene.tree->half.x + scene.tree->half.y + scene.tree->half.z;
}

/// Adds the plane with this normal, turned towards the axis by more than it rounds, if it then holds.
HWY_NOINLINE void add_plane(const HullRays& rays, const double* normal, const double* axis, double cosine,
                            GroupBeam& beam) {
    double length = 0, n[3];
    for (int a = 0; a < 3; ++a) length += normal[a] * normal[a];
    if (!(length > 0) || !(cosine > 0)) return;
    const int to = beam.planes;
    const double shortness = 1 / std::sqrt(length), turn = 0x1p-21 / cosine;
    for (int a = 0; a < 3; ++a) {
        beam.plane[to][a] = static_cast<float>(normal[a] * shortness + turn * axis[a]);
        n[a] = beam.plane[to][a];
    }
    const Vector3 plane = set_vector(n);
    Double offset = hn::Set(kDouble, INFINITY), along = offset;
    for (std::size_t at = 0; at < rays.count; at += kDoubles) {
        along = hn::Min(along, dot(load_ray(rays.direction, at), plane));
        offset = hn::Min(offset, dot(load_ray(rays.origin, at), plane));
    }
    if (!(least_of(along) >= 0)) return;
    beam.offset[to] = static_cast<float>(least_of(offset) - kPlaneErrorBound * rays.size);
    ++beam.planes;
}

/// What the hull's rays have in common along an axis.
struct AlongAxis {
    double speed = 0, start = 0, cosine = 0;  // largest, largest, least
};

HWY_INLINE AlongAxis measure_along(const HullRays& rays, const double* axis) {
    const Vector3 ahead = set_vector(axis);
    Double speed = hn::Zero(kDouble), start = hn::Set(kDouble, -INFINITY), cosine = hn::Set(kDouble, 1.0);
    for (std::size_t at = 0; at < rays.count; at += kDoubles) {
        const Double along = dot(load_ray(rays.direction, at), ahead);
        cosine = hn::Min(cosine, hn::Mul(along, hn::Load(kDouble, rays.shortness + at)));
        speed = hn::Max(speed, along);
        start = hn::Max(start, dot(load_ray(rays.origin, at), ahead));
    }
    return {largest_of(speed), largest_of(start), least_of(cosine)};
}

/// Two directions square to the unit vector `axis` and to each other: the coordinate axis where it is
/// smallest, made square to it, and their product. At least 0.8 long, at most 1.
HWY_INLINE void directions_across(const double (&axis)[3], double (&across)[2][3]) {
    const int least = std::fabs(axis[0]) <= std::fabs(axis[1])
                          ? (std::fabs(axis[0]) <= std::fabs(axis[2]) ? 0 : 2)
                          : (std::fabs(axis[1]) <= std::fabs(axis[2]) ? 1 : 2);
    for (int a = 0; a < 3; ++a) across[0][a] = (a == least ? 1 : 0) - axis[least] * axis[a];
    for (int a = 0; a < 3; ++a) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        across[1][a] = axis[b] * across[0][c] - axis[c] * across[0][b];
    }
}

/// A pair of planes that hold the rays' slopes to `side`.
HWY_INLINE void add_slopes(const HullRays& rays, const double* side, const double* axis, double cosine,
                           GroupBeam& beam) {
    Double low = hn::Set(kDouble, INFINITY), high = hn::Set(kDouble, -INFINITY);
    const Vector3 across = set_vector(side), ahead = set_vector(axis);
    for (std::size_t at = 0; at < rays.count; at += kDoubles) {
        const Vector3 d = load_ray(rays.direction, at);
        const Double slope = hn::Div(dot(d, across), dot(d, ahead));
        low = hn::Min(low, slope);
        high = hn::Max(high, slope);
    }
    const double least = least_of(low), most = largest_of(high);
    double n[3];
    for (int a = 0; a < 3; ++a) n[a] = side[a] - least * axis[a];
    add_plane(rays, n, axis, cosine, beam);
    for (int a = 0; a < 3; ++a) n[a] = most * axis[a] - side[a];
    add_plane(rays, n, axis, cosine, beam);
}

/// The rays' mean direction, not unit; also sets `shortness`, 1 / length or 0.
HWY_INLINE void mean_direction(HullRays& rays, double (&axis)[3]) {
    Vector3 sum = {hn::Zero(kDouble), hn::Zero(kDouble), hn::Zero(kDouble)};
    for (std::size_t at = 0; at < rays.count; at += kDoubles) {
        const Vector3 d = load_ray(rays.direction, at);
        const Double square = dot(d, d);
        const Double inverse = hn::Div(hn::Set(kDouble, 1.0), hn::Sqrt(square));
        const Double own = hn::IfThenElseZero(hn::Gt(square, hn::Zero(kDouble)), inverse);
        hn::Store(own, kDouble, rays.shortness + at);
        sum = plus(sum, times(own, d));
    }
    axis[0] = sum_of(sum.x);
    axis[1] = sum_of(sum.y);
    axis[2] = sum_of(sum.z);
}

/// Around all of the group's rays: two pairs of planes along the mean direction and one across it.
HWY_NOINLINE void make_group_beam(const KernelScene& scene, const KernelState& state, GroupBeam& beam) {
    HullRays rays;
    gather_hulls(scene, state, rays);
    beam.planes = 0;
    double axis[3], length = 0;
    mean_direction(rays, axis);
    for (const double a : axis) length += a * a;
    beam.start = 0;
    beam.speed_inverse = 0;
    if (!(length > 1e-12)) return;
    const double shortness = 1 / std::sqrt(length);
    for (int a = 0; a < 3; ++a) {
        beam.axis[a] = static_cast<float>(axis[a] * shortness);
        axis[a] = beam.axis[a];
    }
    const AlongAxis along = measure_along(rays, axis);
    beam.start = static_cast<float>(along.start + kPlaneErrorBound * rays.size);
    beam.speed_inverse = along.speed > 0 ? static_cast<float>((1 - 1e-6) / along.speed) : 0;
    if (!(along.cosine > 1e-3)) return;

    add_plane(rays, axis, axis, along.cosine, beam);
    if (state.group.tiles == 1) {
        for (int k = 0; k < 4; ++k) {
            if (!(state.lanes.hull.offset[k][state.group.first_lane] > -kNever)) continue;
            for (int a = 0; a < 3; ++a)
                beam.plane[beam.planes][a] = state.lanes.hull.plane[k][a][state.group.first_lane];
            beam.offset[beam.planes++] = state.lanes.hull.offset[k][state.group.first_lane];
        }
        return;
    }
    double across[2][3];
    directions_across(axis, across);
    for (const double* side : {across[0], across[1]}) add_slopes(rays, side, axis, along.cosine, beam);
}

// Beams around single vectors of samples, 16 at once, and what reaches into them.

/// Beams around all of the group's vectors, 16 at a time.
HWY_NOINLINE void make_vector_beams(const KernelScene& scene, KernelState& state) {
    state.work.beams_made = true;
    state.work.rays_made.assign(state.group.vectors, 0);
    state.work.tile_of_vector.resize(state.group.vectors);
    if (state.work.rays.size() < state.group.vectors) state.work.rays.resize(state.group.vectors);
    state.work.beams.resize((state.group.vectors + kLanes - 1) / kLanes);
    for (std::uint32_t j = state.group.first_lane; j < state.group.first_lane + state.group.tiles; ++j) {
        const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
        std::fill_n(state.work.tile_of_vector.begin() + (tile.first_vector - state.group.first_vector),
                    tile.vectors, static_cast<std::uint8_t>(j));
    }
    TileFrusta hull;
    for (std::uint32_t g = 0; g * kLanes < state.group.vectors; ++g) {
        for (std::uint32_t k = 0; k < kLanes; ++k) {
            const std::uint32_t vector =
                std::min(g * static_cast<std::uint32_t>(kLanes) + k, state.group.vectors - 1);
            const std::size_t j = state.work.tile_of_vector[vector];
            const SampleTile& tile = scene.tiles->tiles[state.group.first_tile + j];
            const std::uint32_t own = vector + state.group.first_vector - tile.first_vector;
            const VectorBoxes& box = scene.tiles->boxes[tile.first_boxes + own / kLanes];
            const std::size_t b = own % kLanes;
            // No thinner than a third of a sample, so that the hull has sides.
            const double half_u = std::max<double>(box.half_u[b], 0.6 / std::max(1, tile.width - 1)),
                         half_v = std::max<double>(box.half_v[b], 0.6 / std::max(1, tile.height - 1));
            const double weight =
                put_rectangle(state.lanes, j, {box.centre_u[b], box.centre_v[b], half_u, half_v}, hull, k);
            for (int a = 0; a < 3; ++a) hull.centre[a][k] = state.lanes.centre[a][j];
            hull.origin_terms[k] =
                weight > 0.1 ? state.lanes.origin_terms[j] : std::numeric_limits<double>::infinity();
        }
        make_planes(scene, hull);
        VectorBeams& beams = state.work.beams[g];
        std::memcpy(beams.plane, hull.plane, sizeof beams.plane);
        std::memcpy(beams.offset, hull.offset, sizeof beams.offset);
        for (std::uint32_t k = 0; k < kLanes; ++k)
            beams.farthest[k] = g * kLanes + k < state.group.vectors ? kNever : -kNever;
    }
}

/// The offsets of vectors' planes as seen from a box's middle.
struct alignas(64) PlaneHeights {
    float from_middle[4][kLanes];
};

/// Which of 16 vectors' beams reach a box, before their samples all see something nearer. Fills `heights`.
HWY_INLINE std::uint32_t vectors_at_box(const VectorBeams& beams, const float* middle, const float* half,
                                        float nearest, PlaneHeights& heights) {
    const Floats cx = set(middle[0]), cy = set(middle[1]), cz = set(middle[2]);
    const Floats hx = set(half[0]), hy = set(half[1]), hz = set(half[2]);
    Mask missed = set(nearest) > load(beams.farthest);
    for (int k = 0; k < 4; ++k) {
        const Floats x = load(beams.plane[k][0]), y = load(beams.plane[k][1]), z = load(beams.plane[k][2]);
        const Floats swing = multiply_add(absolute(x), hx, multiply_add(absolute(y), hy, absolute(z) * hz));
        const Floats height =
            subtract_product(x, cx, subtract_product(y, cy, subtract_product(z, cz, load(beams.offset[k]))));
        store(height, heights.from_middle[k]);
        missed = missed | (swing < height);
    }
    return kAllLanes & ~bits(missed);
}

/// The leaf's triangles that reach into one vector's beam. `heights`: of the planes over the leaf's middle.
HWY_INLINE std::uint32_t triangles_in_vector(const VectorBeams& beams, const PlaneHeights& heights,
                                             std::size_t lane, const Leaf& leaf) {
    Mask missed = mask_of(0);
    for (int p = 0; p < 4; ++p) {
        const Floats x = set(beams.plane[p][0][lane]), y = set(beams.plane[p][1][lane]),
                     z = set(beams.plane[p][2][lane]);
        Floats height = set(-kNever);
        for (int k = 0; k < 3; ++k)
            height = largest(height, multiply_add(x, load(leaf.x[k]),
                                                  multiply_add(y, load(leaf.y[k]), z * load(leaf.z[k]))));
        missed = missed | (height < set(heights.from_middle[p][lane]));
    }
    return first_lanes(leaf.count) & ~bits(missed);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
