// The hulls of tiles' rays, 16 at once, and planes around them.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_HULLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_HULLS_INL_H
#undef TRILENS_KERNEL_HULLS_INL_H
#else
#define TRILENS_KERNEL_HULLS_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "projector/kernel/kernel_doubles-inl.h"
#include "projector/kernel/kernel_scene.h"

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
                                  HullLanes& hull, std::size_t at) {
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
    constexpr double kReach = 1 + 1e-6, kPositive = 0.1;
    if (!tile.whole_facet || !(tile.least_weight > -1)) {
        if (put_rectangle(lanes, j, {0, 0, kReach, kReach}, lanes.hull, j) > kPositive) return;
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
HWY_NOINLINE void make_planes(const KernelScene& scene, HullLanes& lanes) {
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
        Double cosine = inner(axis, d[0]);
        for (int k = 1; k < 4; ++k) cosine = hn::Min(cosine, inner(axis, d[k]));
        const Double turn = hn::Div(hn::Set(kDouble, 0x1p-21), hn::Max(cosine, hn::Set(kDouble, 1e-3)));
        const Vector3 centre = load3(lanes.centre, at);
        const Vector3 from_tree = {hn::Sub(centre.x, hn::Set(kDouble, tree.centre.x)),
                                   hn::Sub(centre.y, hn::Set(kDouble, tree.centre.y)),
                                   hn::Sub(centre.z, hn::Set(kDouble, tree.centre.z))};
        for (int k = 0; k < 4; ++k) {
            const int next = (k + 1) % 4;
            Vector3 normal = outer(d[k], d[next]);
            step = outer(minus(o[next], o[k]), axis);
            const auto parallel = hn::Lt(inner(normal, normal), hn::Set(kDouble, 1e-14));
            normal = {hn::IfThenElse(parallel, step.x, normal.x), hn::IfThenElse(parallel, step.y, normal.y),
                      hn::IfThenElse(parallel, step.z, normal.z)};
            // Into the hull: towards the other corners.
            Double inside = zero;
            for (int m = 0; m < 4; ++m)
                inside = hn::Add(
                    inside, hn::IfThenElse(parallel, inner(normal, minus(o[m], o[k])), inner(normal, d[m])));
            const Double sign =
                hn::IfThenElse(hn::Lt(inside, zero), hn::Set(kDouble, -1.0), hn::Set(kDouble, 1.0));
            normal = plus(times(sign, unit(normal)), times(turn, axis));

            const Vector3 rounded = store_floats(normal, lanes.plane[k], at);
            Double along = inner(rounded, d[0]), offset = inner(rounded, o[0]), size = zero;
            for (int m = 0; m < 4; ++m) {
                along = hn::Min(along, inner(rounded, d[m]));
                offset = hn::Min(offset, inner(rounded, o[m]));
                size = hn::Max(size, hn::Add(hn::Abs(o[m].x), hn::Add(hn::Abs(o[m].y), hn::Abs(o[m].z))));
            }
            size = hn::Max(size, hn::Mul(hn::Set(kDouble, 1e-6), hn::Load(kDouble, lanes.origin_terms + at)));
            size = hn::Add(
                size, hn::Add(hn::Abs(from_tree.x), hn::Add(hn::Abs(from_tree.y), hn::Abs(from_tree.z))));
            size = hn::Add(size, hn::Set(kDouble, reach));
            offset = hn::Add(offset, inner(rounded, from_tree));
            offset = hn::Sub(offset, hn::Mul(hn::Set(kDouble, kPlaneDoubt), size));
            const auto holds = hn::Gt(along, hn::Set(kDouble, 1e-12));
            offset = hn::IfThenElse(holds, offset, hn::Set(kDouble, -1e300));
            const hn::Rebind<float, DoubleTag> some;
            hn::Store(hn::DemoteTo(some, offset), some, lanes.offset[k] + at);
        }
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
