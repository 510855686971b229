// Set-up of 16 tiles at once: their rays as functions of the tile's coordinates, and the frusta around them.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_SETUP_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_SETUP_INL_H
#undef TRILENS_KERNEL_SETUP_INL_H
#else
#define TRILENS_KERNEL_SETUP_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/exact/exact_hit.h"
#include "projector/kernel/kernel.h"
#include "projector/kernel/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// A rectangle of local coordinates.
struct LocalRectangle {
    double u, v, half_u, half_v;
};

/// Into lane `at` of `hull`: the rays at the rectangle's corners, of the tile of lane j. Returns the least
/// weight there: they are a hull where it is positive.
HWY_NOINLINE double put_rectangle(const TileLanes& lanes, std::size_t j, const LocalRectangle& r,
                                  TileFrusta& hull, std::size_t at) {
    constexpr double kU[4] = {-1, 1, 1, -1}, kV[4] = {-1, -1, 1, 1};
    double least = INFINITY;
    for (std::size_t k = 0; k < 4; ++k) {
        const double u = r.u + kU[k] * r.half_u, v = r.v + kV[k] * r.half_v;
        const double weight = lanes.weight[0][j] + u * lanes.weight[1][j] + v * lanes.weight[2][j];
        const double inverse = 1 / weight;
        least = std::min(least, weight);
        for (int a = 0; a < 3; ++a) {
            hull.origin[k][a][at] =
                inverse * (lanes.origin[a][0][j] + u * lanes.origin[a][1][j] + v * lanes.origin[a][2][j]);
            hull.direction[k][a][at] = inverse * (lanes.direction[a][0][j] + u * lanes.direction[a][1][j] +
                                                  v * lanes.direction[a][2][j]);
        }
    }
    return least;
}

/// The hull of the rays of a tile: where the tile is part of its facet, of the rays at its rectangle's
/// corners, if the weight is positive there; else of the facet's corner rays, widened to the outermost
/// sample. Both by convexity of the weights.
HWY_NOINLINE void gather_hull(const KernelScene& scene, const SampleTile& tile, std::size_t j,
                              TileLanes& lanes) {
    constexpr double kRectangleReach = 1 + 1e-6, kPositive = 0.1;
    if (!tile.whole_facet || !(tile.least_weight > -1)) {
        if (put_rectangle(lanes, j, {0, 0, kRectangleReach, kRectangleReach}, lanes.hull, j) > kPositive)
            return;
    }
    const IdTriple& corner = scene.mesh->facets[tile.facet];
    const double out = std::min(0.0, tile.least_weight) - 1e-9;  // the weight of the other two corners
    for (int a = 0; a < 3; ++a) {
        double o[3], d[3];
        for (std::size_t k = 0; k < 3; ++k) {
            o[k] = scene.mesh->rays[corner[k]].origin[a] - lanes.centre[a][j];
            d[k] = scene.mesh->rays[corner[k]].direction[a];
        }
        const double o_sum = out * (o[0] + o[1] + o[2]), d_sum = out * (d[0] + d[1] + d[2]);
        for (std::size_t k = 0; k < 4; ++k) {
            lanes.hull.origin[k][a][j] = o_sum + (1 - 3 * out) * o[std::min<std::size_t>(k, 2)];
            lanes.hull.direction[k][a][j] = d_sum + (1 - 3 * out) * d[std::min<std::size_t>(k, 2)];
        }
    }
}

/// Planes around each tile's hull. A plane holds only if, as floats, its normal points along all four corner
/// directions; it is turned towards the axis by more than it rounds, then checked.
HWY_NOINLINE void make_planes(const KernelScene& scene, TileFrusta& lanes) {
    const LeafTree& tree = *scene.tree;
    const double reach = tree.half.x + tree.half.y + tree.half.z;
    const Double zero = hn::Zero(kDouble);
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        Vector3 o[4], d[4], step;
        for (int k = 0; k < 4; ++k) {
            o[k] = load3(lanes.origin[k], at);
            d[k] = unit(load3(lanes.direction[k], at));
        }
        const Vector3 axis = unit(plus(plus(d[0], d[1]), plus(d[2], d[3])));
        Double cosine = dot(axis, d[0]);
        for (int k = 1; k < 4; ++k) cosine = hn::Min(cosine, dot(axis, d[k]));
        const Double turn = hn::Div(hn::Set(kDouble, 0x1p-21), hn::Max(cosine, hn::Set(kDouble, 1e-3)));
        const Vector3 centre = load3(lanes.centre, at);
        const Vector3 from_tree = {hn::Sub(centre.x, hn::Set(kDouble, tree.centre.x)),
                                   hn::Sub(centre.y, hn::Set(kDouble, tree.centre.y)),
                                   hn::Sub(centre.z, hn::Set(kDouble, tree.centre.z))};
        for (int k = 0; k < 4; ++k) {
            const int next = (k + 1) % 4;
            Vector3 normal = cross(d[k], d[next]);
            step = cross(minus(o[next], o[k]), axis);
            const auto parallel = hn::Lt(dot(normal, normal), hn::Set(kDouble, 1e-14));
            normal = {hn::IfThenElse(parallel, step.x, normal.x), hn::IfThenElse(parallel, step.y, normal.y),
                      hn::IfThenElse(parallel, step.z, normal.z)};
            // Into the hull: towards the other corners.
            Double inside = zero;
            for (int m = 0; m < 4; ++m)
                inside = hn::Add(inside,
                                 hn::IfThenElse(parallel, dot(normal, minus(o[m], o[k])), dot(normal, d[m])));
            const Double sign =
                hn::IfThenElse(hn::Lt(inside, zero), hn::Set(kDouble, -1.0), hn::Set(kDouble, 1.0));
            normal = plus(times(sign, unit(normal)), times(turn, axis));

            const Vector3 rounded = store_floats(normal, lanes.plane[k], at);
            Double along = dot(rounded, d[0]), offset = dot(rounded, o[0]), size = zero;
            for (int m = 0; m < 4; ++m) {
                along = hn::Min(along, dot(rounded, d[m]));
                offset = hn::Min(offset, dot(rounded, o[m]));
                size = hn::Max(size, hn::Add(hn::Abs(o[m].x), hn::Add(hn::Abs(o[m].y), hn::Abs(o[m].z))));
            }
            size = hn::Max(size, hn::Mul(hn::Set(kDouble, 1e-6), hn::Load(kDouble, lanes.origin_terms + at)));
            size = hn::Add(
                size, hn::Add(hn::Abs(from_tree.x), hn::Add(hn::Abs(from_tree.y), hn::Abs(from_tree.z))));
            size = hn::Add(size, hn::Set(kDouble, reach));
            offset = hn::Add(offset, dot(rounded, from_tree));
            offset = hn::Sub(offset, hn::Mul(hn::Set(kDouble, kPlaneErrorBound), size));
            const auto holds = hn::Gt(along, hn::Set(kDouble, 1e-12));
            offset = hn::IfThenElse(holds, offset, hn::Set(kDouble, -1e300));
            const hn::Rebind<float, DoubleTag> some;
            hn::Store(hn::DemoteTo(some, offset), some, lanes.offset[k] + at);
        }
    }
}

// Set-up: 16 tiles at once, their rays as functions of local coordinates, and their hulls.

/// Copies what one tile brings into its lane: the facet's rays, moved to the tile's rectangle.
HWY_NOINLINE void gather_tile(const KernelScene& scene, const SampleTile& tile, std::size_t j,
                              TileLanes& lanes) {
    const FacetRays& facet = scene.tiles->rays[tile.rays];
    const TileFrame frame = tile_frame(tile, *scene.grid);
    const Vec2 from = frame.centre - facet.screen;
    const double parts[3] = {1, frame.half.x, frame.half.y};
    double origin_terms = 0;
    const std::array<double, 3>& w = facet.rays.weight;
    for (int a = 0; a < 3; ++a) {
        const double o0 = facet.rays.origin[0][a], o1 = facet.rays.origin[1][a], o2 = facet.rays.origin[2][a];
        const double d0 = facet.rays.direction[0][a], d1 = facet.rays.direction[1][a],
                     d2 = facet.rays.direction[2][a];
        lanes.centre[a][j] = lanes.hull.centre[a][j] = facet.centre[a];
        lanes.origin[a][0][j] = o0 + from.x * o1 + from.y * o2;
        lanes.origin[a][1][j] = parts[1] * o1;
        lanes.origin[a][2][j] = parts[2] * o2;
        lanes.direction[a][0][j] = d0 + from.x * d1 + from.y * d2;
        lanes.direction[a][1][j] = parts[1] * d1;
        lanes.direction[a][2][j] = parts[2] * d2;
        const double reach_x = std::fabs(from.x) + parts[1], reach_y = std::fabs(from.y) + parts[2];
        origin_terms += std::fabs(o0) + reach_x * std::fabs(o1) + reach_y * std::fabs(o2);
        lanes.direction_sum[a][j] = std::fabs(d0) + reach_x * std::fabs(d1) + reach_y * std::fabs(d2);
    }
    lanes.weight[0][j] = w[0] + from.x * w[1] + from.y * w[2];
    lanes.weight[1][j] = parts[1] * w[1];
    lanes.weight[2][j] = parts[2] * w[2];
    lanes.weight_low[j] = tile.low;
    lanes.weight_high[j] = tile.high;
    lanes.origin_terms[j] = origin_terms;
    lanes.weight_terms[j] = std::fabs(w[0]) + (std::fabs(from.x) + parts[1]) * std::fabs(w[1]) +
                            (std::fabs(from.y) + parts[2]) * std::fabs(w[2]);
}

/// Of a sample, where the largest in its tile is 1.
inline constexpr double kLeastWeight = 0.4;

/// Scales a lane's rays to weight 1 where it is largest of the samples' and bounds them.
HWY_NOINLINE void scale_lanes(TileLanes& lanes) {
    for (std::size_t j = 0; j < kLanes; ++j) {
        const double s = 1 / lanes.weight_high[j];
        for (int p = 0; p < 3; ++p) {
            lanes.weight[p][j] *= s;
            for (int a = 0; a < 3; ++a) {
                lanes.origin[a][p][j] *= s;
                lanes.direction[a][p][j] *= s;
            }
        }
        lanes.weight_low[j] *= s;
        lanes.origin_terms[j] *= s;
        lanes.weight_terms[j] *= s;
        const double direction_terms =
            s * (lanes.direction_sum[0][j] + lanes.direction_sum[1][j] + lanes.direction_sum[2][j]);
        lanes.weight_sum[j] =
            std::fabs(lanes.weight[0][j]) + std::fabs(lanes.weight[1][j]) + std::fabs(lanes.weight[2][j]);
        const double weight_least = lanes.weight_low[j] - kDecisionErrorBound * lanes.weight_terms[j];
        lanes.decision_error[j] = kDecisionErrorBound * direction_terms / weight_least;
        for (int a = 0; a < 3; ++a)
            lanes.direction_sum[a][j] = std::fabs(lanes.direction[a][0][j]) +
                                        std::fabs(lanes.direction[a][1][j]) +
                                        std::fabs(lanes.direction[a][2][j]);
    }
    // Tiles over whose samples the weight changes much, or its sign, and what is not finite.
    std::uint32_t broken = 0;
    for (std::size_t j = 0; j < kLanes; ++j) {
        const bool good = lanes.weight_low[j] >= kLeastWeight && lanes.decision_error[j] >= 0 &&
                          std::isfinite(lanes.decision_error[j]) && std::isfinite(lanes.origin_terms[j]);
        broken |= good ? 0 : 1u << j;
    }
    lanes.broken = broken;
}

HWY_INLINE void store3(const Vector3& v, double (*to)[6][kLanes], int q, std::size_t at) {
    hn::Store(v.x, kDouble, to[0][q] + at);
    hn::Store(v.y, kDouble, to[1][q] + at);
    hn::Store(v.z, kDouble, to[2][q] + at);
}
/// The quadratics of the rays' Pluecker coordinates (trilinear/facet/edge_conic.h, line_quadratic).
HWY_NOINLINE void make_lines(TileLanes& lanes) {
    for (std::size_t at = 0; at < kLanes; at += kDoubles) {
        Vector3 o[3], d[3];
        Double w[3];
        for (int p = 0; p < 3; ++p) {
            o[p] = load_part(lanes.origin, p, at);
            d[p] = load_part(lanes.direction, p, at);
            w[p] = hn::Load(kDouble, lanes.weight[p] + at);
        }
        const auto square = [&](int p) HWY_ATTR { return times(w[p], d[p]); };
        const auto mixed = [&](int p, int r) HWY_ATTR { return plus(times(w[p], d[r]), times(w[r], d[p])); };
        const Vector3 line[6] = {square(0), mixed(0, 1), mixed(0, 2), square(1), mixed(1, 2), square(2)};
        const auto mixed_moment = [&](int p, int r)
                                      HWY_ATTR { return plus(cross(o[p], d[r]), cross(o[r], d[p])); };
        const Vector3 moment[6] = {cross(o[0], d[0]), mixed_moment(0, 1), mixed_moment(0, 2),
                                   cross(o[1], d[1]), mixed_moment(1, 2), cross(o[2], d[2])};
        Vector3 sum = absolute(line[0]);
        for (int q = 1; q < 6; ++q) sum = plus(sum, absolute(line[q]));
        for (int q = 0; q < 6; ++q) {
            store3(line[q], lanes.line, q, at);
            store3(moment[q], lanes.moment, q, at);
        }
        hn::Store(sum.x, kDouble, lanes.line_sum[0] + at);
        hn::Store(sum.y, kDouble, lanes.line_sum[1] + at);
        hn::Store(sum.z, kDouble, lanes.line_sum[2] + at);
    }
}

/// Copies a tile's coefficients together, once.
HWY_NOINLINE void transpose_tile(std::size_t j, TileLanes& lanes) {
    for (int a = 0; a < 3; ++a) {
        for (int q = 0; q < 6; ++q) {
            lanes.tile[j][a][q] = lanes.line[a][q][j];
            lanes.tile[j][3 + a][q] = lanes.moment[a][q][j];
        }
        for (int p = 0; p < 3; ++p) {
            lanes.tile[j][6 + a][p] = lanes.origin[a][p][j];
            lanes.tile[j][9 + a][p] = lanes.direction[a][p][j];
        }
    }
    for (int p = 0; p < 3; ++p) lanes.tile[j][12][p] = lanes.weight[p][j];
    lanes.transposed |= 1u << j;
}

/// About how far apart the rays of a tile's neighbouring samples are, where the weight is 1.
HWY_NOINLINE void measure_pitch(const TileLanes& lanes, std::size_t j, const SampleTile& tile,
                                float (&pitch)[4]) {
    for (int p = 1; p < 3; ++p) {
        double origin = 0, direction = 0;
        for (int a = 0; a < 3; ++a) {
            const double o = lanes.origin[a][p][j] - lanes.origin[a][0][j] * lanes.weight[p][j];
            const double d = lanes.direction[a][p][j] - lanes.direction[a][0][j] * lanes.weight[p][j];
            origin += o * o;
            direction += d * d;
        }
        const double cells = std::max(0.5, 0.5 * ((p == 1 ? tile.width : tile.height) - 1));
        pitch[2 * p - 2] = static_cast<float>(std::sqrt(origin) / cells);
        pitch[2 * p - 1] = static_cast<float>(std::sqrt(direction) / cells);
    }
}

/// What gather_hull() reads of the mesh.
HWY_INLINE void prefetch_corner_rays(const KernelScene& scene, const SampleTile* tile, std::uint32_t tiles) {
    for (std::uint32_t j = 0; j < tiles; ++j) {
        if (!tile[j].whole_facet) continue;
        for (const Id corner : scene.mesh->facets[tile[j].facet]) {
            const char* from = reinterpret_cast<const char*>(&scene.mesh->rays[corner]);
            hwy::Prefetch(from);
            hwy::Prefetch(from + sizeof(Ray) - 1);
        }
    }
}

/// Whether there is anything for beams to cut off: a single leaf is drawn whole.
HWY_INLINE bool has_nodes(const LeafTree& tree) {
    return !tree.empty() && tree.root >= 0;
}

/// All lanes of a batch; lanes beyond its tiles repeat the last. Hulls only where the tree has nodes.
HWY_NOINLINE void set_up_batch(const KernelScene& scene, const SampleTile* tile, std::uint32_t tiles,
                               TileLanes& lanes) {
    for (std::size_t j = 0; j < kLanes; ++j)
        gather_tile(scene, tile[std::min<std::size_t>(j, tiles - 1)], j, lanes);
    const bool hulls = has_nodes(*scene.tree);
    if (hulls) prefetch_corner_rays(scene, tile, tiles);
    scale_lanes(lanes);
    make_lines(lanes);
    lanes.transposed = 0;
    if (!hulls) return;
    for (std::size_t j = 0; j < kLanes; ++j)
        gather_hull(scene, tile[std::min<std::size_t>(j, tiles - 1)], j, lanes);
    std::copy_n(lanes.origin_terms, kLanes, lanes.hull.origin_terms);
    make_planes(scene, lanes.hull);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
