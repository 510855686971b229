// One triangle against 16 samples: sure hits are kept, sure misses forgotten, all else listed as doubts.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_OFFER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_OFFER_INL_H
#undef TRILENS_KERNEL_OFFER_INL_H
#else
#define TRILENS_KERNEL_OFFER_INL_H
#endif

#include "projector/exact/decide.h"
#include "projector/kernel/kernel_lanes-inl.h"
#include "projector/kernel/kernel_scene.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// What floats may be wrong by, for one tile and one leaf.
struct TileDoubts {
    float edge = 0;              // of an edge's conic
    float above = 0, along = 0;  // twice that of the depth's numerator and of its denominator
};

/// The absolute sums that bound a tile's terms in a leaf.
struct TileSums {
    double moment[3];  // of the moments' coefficients, about the leaf's centre
    double origin[3];  // of the origins' coefficients, from there
    double reach;      // of the leaf's farthest point from the facet's centre, in the 1-norm
};

/// kEdgeDoubt and kDepthDoubt say why this is enough.
HWY_INLINE TileDoubts doubts_of(const TileLanes& lanes, std::size_t j, const Leaf& leaf,
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
    TileDoubts doubts;
    doubts.edge = static_cast<float>(kEdgeDoubt * edge + 1.0001 * lanes.decision_doubt[j] * far * far + tiny);
    doubts.along = static_cast<float>(2 * (kDepthDoubt * along + tiny));
    doubts.above = static_cast<float>(
        2 * (kDepthDoubt * above + 8 * kDecisionDoubt * (hh[0] + hh[1] + hh[2]) * far + tiny));
    return doubts;
}

HWY_NOINLINE void list_doubts(KernelState& state, std::uint32_t vector, std::uint32_t lanes,
                              std::uint32_t triangle) {
    if (state.doubts.size() > state.most_doubts) return;
    for (Each lane(lanes); lane; ++lane) state.doubts.push_back({vector, *lane, triangle});
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

/// The same, and lists those of them that are `valid`.
HWY_INLINE void offer_lanes(KernelState& state, std::uint32_t vector, std::uint32_t triangle,
                            const Meeting& m, std::uint32_t valid) {
    const std::uint32_t doubtful = valid & keep_nearest(state.nearest[vector], triangle, m);
    if (HWY_UNLIKELY(doubtful != 0)) list_doubts(state, vector, doubtful, triangle);
}

/// The same for one sample.
HWY_INLINE void offer_one(KernelState& state, std::uint32_t vector, std::uint32_t lane, Id triangle,
                          float t_low, float t_high, bool inside, bool placed) {
    Nearest& nearest = state.nearest[vector];
    if (placed && (t_high < 0 || t_low > nearest.high[lane])) return;
    if (inside && placed && t_low > 0 && t_high < nearest.low[lane]) {
        nearest.low[lane] = t_low;
        nearest.high[lane] = t_high;
        nearest.triangle[lane] = triangle;
        return;
    }
    list_doubts(state, vector, 1u << lane, triangle);
}

/// How far t = above / along may be off where along is more than its doubt, which is twice what it rounds by.
HWY_INLINE Floats doubt_of_time(const Floats& t, const Floats& inverse, const Floats& above,
                                const Floats& along) {
    return multiply_add(absolute(t), set(kTimeDoubt), inverse * multiply_add(absolute(t), along, above));
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
