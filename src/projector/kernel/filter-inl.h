// The floating-point filter: a triangle against 16 samples in floats with error bounds. Sure hits are kept,
// sure misses forgotten, all else is listed as ambiguous. Included once per instruction set.
#if defined(TRILENS_KERNEL_FILTER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_FILTER_INL_H
#undef TRILENS_KERNEL_FILTER_INL_H
#else
#define TRILENS_KERNEL_FILTER_INL_H
#endif

#include "projector/exact/exact_hit.h"
#include "projector/kernel/kernel.h"
#include "projector/kernel/setup-inl.h"
#include "projector/kernel/simd-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// What floats may be wrong by, for one tile and one leaf.
struct TileErrorBounds {
    float edge = 0;              // of an edge's conic
    float above = 0, along = 0;  // twice that of the depth's numerator and of its denominator
};

/// The absolute sums that bound a tile's terms in a leaf.
struct TileSums {
    double moment[3];  // of the moments' coefficients, about the leaf's centre
    double origin[3];  // of the origins' coefficients, from there
    double reach;      // of the leaf's farthest point from the facet's centre, in the 1-norm
};

/// kEdgeErrorBound and kDepthErrorBound say why this is enough.
HWY_INLINE TileErrorBounds error_bounds_of(const TileLanes& lanes, std::size_t j, const Leaf& leaf,
                                           const TileSums& sums) {
    const double h[3] = {leaf.half[0], leaf.half[1], leaf.half[2]};
    const double hh[3] = {h[1] * h[2], h[2] * h[0], h[0] * h[1]};
    double edge = 0, above = 0, along = 0, all = 0;
    for (int a = 0; a < 3; ++a) {
        edge += lanes.line_sum[a][j] * hh[a] + sums.moment[a] * h[a];
        along += lanes.direction_sum[a][j] * hh[a];
        above += hh[a] * (sums.origin[a] + lanes.weight_sum[j] * h[a]);
        all += lanes.line_sum[a][j] + sums.moment[a] + sums.origin[a];
    }
    const double far = lanes.weight_terms[j] * sums.reach + lanes.origin_terms[j];
    const double tiny = static_cast<double>(kUnderflow) * (1 + all);
    TileErrorBounds errors;
    errors.edge =
        static_cast<float>(kEdgeErrorBound * edge + 1.0001 * lanes.decision_error[j] * far * far + tiny);
    errors.along = static_cast<float>(2 * (kDepthErrorBound * along + tiny));
    errors.above = static_cast<float>(
        2 * (kDepthErrorBound * above + 8 * kDecisionErrorBound * (hh[0] + hh[1] + hh[2]) * far + tiny));
    return errors;
}

HWY_NOINLINE void list_ambiguous(KernelState& state, std::uint32_t vector, std::uint32_t lanes,
                                 std::uint32_t triangle) {
    if (state.seen.ambiguous.size() > state.seen.most_ambiguous) return;
    for (Each lane(lanes); lane; ++lane) state.seen.ambiguous.push_back({vector, *lane, triangle});
}

/// What floats know of one triangle at 16 samples.
struct Meeting {
    Mask missed, inside;  // for sure
    Mask placed;          // its depth is known: t within `off`
    Floats t, off;
};

/// Keeps the hits that are sure and nearer than all before. Returns the lanes where the triangle may matter
/// or not.
HWY_INLINE std::uint32_t keep_nearest(Nearest& nearest, std::uint32_t triangle, const Meeting& m) {
    const Floats t_low = m.t - m.off, t_high = m.t + m.off;
    const Floats old_low = load(nearest.low), old_high = load(nearest.high);
    const Mask hit = m.inside & m.placed & (t_low > set(0.0f)) & (t_high < old_low);
    const Mask beyond = m.placed & ((t_high < set(0.0f)) | (t_low > old_high));
    const std::uint32_t known = bits(m.missed | beyond | hit);
    store(choose(hit, t_low, old_low), nearest.low);
    store(choose(hit, t_high, old_high), nearest.high);
    store_words(choose(hit, set_word(triangle), load_words(nearest.triangle)), nearest.triangle);
    return kAllLanes & ~known;
}

/// Of lanes that are pixels: where triangles may be seen or not they stay in doubt, beyond what is nearer.
HWY_INLINE void keep_doubts(Doubts& doubts, const Meeting& m, std::uint32_t lanes) {
    const Floats low = choose(m.placed, m.t - m.off, set(-kNever)), old = load(doubts.low);
    store(choose(mask_of(lanes), least(low, old), old), doubts.low);
}

/// How far a linear function, a conic turn over a pixel of the tile, about its middle: nothing where lanes
/// are samples.
HWY_INLINE float swing_of(const float (&c)[3], const SampleTile& tile) {
    return std::fabs(c[1]) * tile.reach_u + std::fabs(c[2]) * tile.reach_v;
}
HWY_INLINE float linear_swing(const float (&c)[3][kLanes], std::size_t lane, const SampleTile& tile) {
    return std::fabs(c[1][lane]) * tile.reach_u + std::fabs(c[2][lane]) * tile.reach_v;
}
HWY_INLINE float conic_swing(const float (&c)[6][kLanes], std::size_t lane, const SampleTile& tile) {
    const float uu = std::fabs(c[3][lane]), uv = std::fabs(c[4][lane]), vv = std::fabs(c[5][lane]);
    return tile.reach_u * (std::fabs(c[1][lane]) + 2 * uu + uv + uu * tile.reach_u) +
           tile.reach_v * (std::fabs(c[2][lane]) + 2 * vv + uv + vv * tile.reach_v) +
           uv * tile.reach_u * tile.reach_v;
}

/// The same, and lists those of them that are `valid`.
HWY_INLINE void offer_lanes(KernelState& state, std::uint32_t vector, std::uint32_t triangle,
                            const Meeting& m, std::uint32_t valid) {
    const std::uint32_t ambiguous = valid & keep_nearest(state.seen.nearest[vector], triangle, m);
    if (HWY_UNLIKELY(ambiguous != 0)) list_ambiguous(state, vector, ambiguous, triangle);
}

/// The same for one sample.
HWY_INLINE void offer_one(KernelState& state, std::uint32_t vector, std::uint32_t lane, Id triangle,
                          float t_low, float t_high, bool inside, bool placed) {
    Nearest& nearest = state.seen.nearest[vector];
    if (placed && (t_high < 0 || t_low > nearest.high[lane])) return;
    if (inside && placed && t_low > 0 && t_high < nearest.low[lane]) {
        nearest.low[lane] = t_low;
        nearest.high[lane] = t_high;
        nearest.triangle[lane] = triangle;
        return;
    }
    list_ambiguous(state, vector, 1u << lane, triangle);
}

/// How far t = above / along may be off where along is more than its error, which is twice what it rounds by.
HWY_INLINE Floats error_of_time(const Floats& t, const Floats& inverse, const Floats& above,
                                const Floats& along) {
    return multiply_add(absolute(t), set(kTimeErrorBound), inverse * multiply_add(absolute(t), along, above));
}

// The functions over a tile that decide triangles: their edges' conics and their depth, and bounds of them.

/// The functions of u and v that decide a triangle, lanes are triangles or tiles: conics of the edges; t =
/// above / along. Turned so that inside is positive.
struct alignas(64) Forms {
    float edge[3][6][kLanes], above[3][kLanes], along[3][kLanes];
};

/// One tile's rays as floats around a leaf's centre.
struct TileInLeaf {
    float line[3][6], moment[3][6], origin[3][3], direction[3][3], weight[3];
    TileErrorBounds errors;
};

HWY_NOINLINE void move_tile_to_leaf(const TileLanes& lanes, std::size_t j, const Leaf& leaf,
                                    TileInLeaf& tile) {
    const double(*c)[8] = lanes.tile[j];
    const double dx = leaf.centre[0] - lanes.centre[0][j], dy = leaf.centre[1] - lanes.centre[1][j],
                 dz = leaf.centre[2] - lanes.centre[2][j];
    TileSums sums{};
    for (int q = 0; q < 6; ++q) {
        const double m[3] = {c[3][q] - (dy * c[2][q] - dz * c[1][q]), c[4][q] - (dz * c[0][q] - dx * c[2][q]),
                             c[5][q] - (dx * c[1][q] - dy * c[0][q])};
        for (int a = 0; a < 3; ++a) {
            tile.line[a][q] = static_cast<float>(c[a][q]);
            tile.moment[a][q] = static_cast<float>(m[a]);
            sums.moment[a] += std::fabs(m[a]);
        }
    }
    const double d[3] = {dx, dy, dz};
    for (int p = 0; p < 3; ++p) {
        for (int a = 0; a < 3; ++a) {
            const double o = c[6 + a][p] - c[12][p] * d[a];
            tile.origin[a][p] = static_cast<float>(o);
            tile.direction[a][p] = static_cast<float>(c[9 + a][p]);
            sums.origin[a] += std::fabs(o);
        }
        tile.weight[p] = static_cast<float>(c[12][p]);
    }
    sums.reach = std::fabs(dx) + std::fabs(dy) + std::fabs(dz) + leaf.half[0] + leaf.half[1] + leaf.half[2];
    tile.errors = error_bounds_of(lanes, j, leaf, sums);
}

/// Linear bounds of the three conics over the tile: conic <= bound[k] + u slope_u[k] + v slope_v[k].
struct EdgeBounds {
    Floats slope_u[3], slope_v[3], bound[3];
    Floats nearest;  // no sample meets it at less than this
};

/// Of which lanes may be seen from the front, where the conics are positive, and from the back.
struct Sides {
    std::uint32_t front = 0, back = 0;
};

/// Middle and swing of a conic over the square: u^2 and v^2 lie in [0, 1].
HWY_INLINE Floats middle_of(const Floats* c) {
    return multiply_add(set(0.5f), c[3] + c[5], c[0]);
}
HWY_INLINE Floats bend_of(const Floats* c, const Floats& error) {
    return error + multiply_add(set(0.5f), absolute(c[3]) + absolute(c[5]), absolute(c[4]));
}

HWY_INLINE Sides sides_of(const Floats (&conic)[3][6], const Floats& error) {
    Mask no_front = mask_of(0), no_back = no_front;
    for (int k = 0; k < 3; ++k) {
        const Floats middle = middle_of(conic[k]);
        const Floats swing = absolute(conic[k][1]) + absolute(conic[k][2]) + bend_of(conic[k], error);
        no_front = no_front | (middle + swing < set(0.0f));
        no_back = no_back | (middle - swing > set(0.0f));
    }
    return {kAllLanes & ~bits(no_front), kAllLanes & ~bits(no_back)};
}

/// Those of the sides that the triangles' planes face somewhere in the tile. The conics' sum is along times
/// the samples' weight, at least kLeastWeight: where that is below -3 edge_error, one of them is below
/// -edge_error.
HWY_INLINE Sides facing_sides(const Sides& sides, const Floats (&along)[3], const Floats& edge_error,
                              const Floats& along_error) {
    constexpr float kEdges = 8;
    static_assert(kEdges * kLeastWeight > 3.1);
    const Floats swing = absolute(along[1]) + absolute(along[2]);
    const Floats error = multiply_add(set(kEdges), edge_error, along_error);
    return {sides.front & ~bits(along[0] + swing + error < set(0.0f)),
            sides.back & ~bits(along[0] - swing - error > set(0.0f))};
}

/// Lanes whose conics, turned, are not surely positive over the whole tile.
HWY_INLINE std::uint32_t partly_outside(const Floats (&conic)[3][6], const Floats& error,
                                        const Floats& flip) {
    Mask partly = mask_of(0);
    for (int k = 0; k < 3; ++k)
        partly = partly | (flip_signs(middle_of(conic[k]), flip) - bend_of(conic[k], error) -
                               absolute(conic[k][1]) - absolute(conic[k][2]) <
                           set(0.0f));
    return bits(partly);
}

/// Numerator and denominator of the depth, turned so that the denominator is positive inside.
struct TurnedDepth {
    Floats above[3], along[3];
};

HWY_INLINE TurnedDepth turn_depth(const Floats (&above)[3], const Floats (&along)[3], const Floats& flip) {
    TurnedDepth depth;
    for (int p = 0; p < 3; ++p) {
        depth.above[p] = flip_signs(above[p], flip);
        depth.along[p] = flip_signs(along[p], flip);
    }
    return depth;
}

/// Lanes whose triangle's plane every ray of the tile surely meets before it starts.
HWY_INLINE Mask behind_tile(const TurnedDepth& depth, const Floats& above_error, const Floats& along_error) {
    const Floats slowest = depth.along[0] - absolute(depth.along[1]) - absolute(depth.along[2]);
    const Floats highest = depth.above[0] + absolute(depth.above[1]) + absolute(depth.above[2]);
    return (slowest > along_error) & (highest + above_error < set(0.0f));
}

/// Where the errors are at most a quarter of what they are of, t is more than half its value, and bounds of
/// it round by less than this.
inline constexpr float kSureDepth = 4, kDepthRound = 1e-4f;

/// The least t at which rays of the tile can meet the triangles, or nothing.
HWY_INLINE Floats least_depth(const TurnedDepth& depth, const Floats& above_error,
                              const Floats& along_error) {
    const Floats along_swing = absolute(depth.along[1]) + absolute(depth.along[2]);
    const Floats lowest = depth.above[0] - absolute(depth.above[1]) - absolute(depth.above[2]);
    const Mask known = (depth.along[0] - along_swing > set(kSureDepth) * along_error) &
                       (lowest > set(kSureDepth) * above_error);
    const Floats least = (lowest - above_error) * reciprocal(depth.along[0] + along_swing + along_error) *
                         set(1 - kDepthRound);
    return choose(known, least, set(-kNever));
}

/// The conics and the depth of 16 triangles through one tile.
HWY_NOINLINE void triangle_forms(const TileInLeaf& tile, const LeafEdges& edges, Floats (&conic)[3][6],
                                 Floats (&above)[3], Floats (&along)[3]) {
    for (int k = 0; k < 3; ++k) {
        const Floats lx = load(edges.edge[k][0]), ly = load(edges.edge[k][1]), lz = load(edges.edge[k][2]);
        const Floats mx = load(edges.moment[k][0]), my = load(edges.moment[k][1]),
                     mz = load(edges.moment[k][2]);
        for (int q = 0; q < 6; ++q) {
            conic[k][q] = multiply_add(
                set(tile.line[0][q]), mx,
                multiply_add(set(tile.line[1][q]), my,
                             multiply_add(set(tile.line[2][q]), mz,
                                          multiply_add(set(tile.moment[0][q]), lx,
                                                       multiply_add(set(tile.moment[1][q]), ly,
                                                                    set(tile.moment[2][q]) * lz)))));
        }
    }
    const Floats nx = load(edges.normal[0]), ny = load(edges.normal[1]), nz = load(edges.normal[2]),
                 height = load(edges.height);
    for (int p = 0; p < 3; ++p) {
        above[p] = subtract_product(
            nx, set(tile.origin[0][p]),
            subtract_product(ny, set(tile.origin[1][p]),
                             subtract_product(nz, set(tile.origin[2][p]), set(tile.weight[p]) * height)));
        along[p] = multiply_add(nx, set(tile.direction[0][p]),
                                multiply_add(ny, set(tile.direction[1][p]), nz * set(tile.direction[2][p])));
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
