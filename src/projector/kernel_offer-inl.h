// One triangle against 16 samples: sure hits are kept, sure misses forgotten, all else listed as doubts.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_OFFER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_OFFER_INL_H
#undef TRILENS_KERNEL_OFFER_INL_H
#else
#define TRILENS_KERNEL_OFFER_INL_H
#endif

#include "projector/decide.h"
#include "projector/kernel_lanes-inl.h"
#include "projector/kernel_scene.h"

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

/// `low`: the least of the three edges' conics, turned so that inside is positive. t = above / along.
HWY_INLINE void offer_lanes(KernelState& state, std::uint32_t vector, std::uint32_t triangle,
                            const TileDoubts& doubts, const Floats& low, const Floats& above,
                            const Floats& along, std::uint32_t valid) {
    Nearest& nearest = state.nearest[vector];
    const Floats inverse = reciprocal(along);
    const Floats t = above * inverse;
    const Floats off =
        multiply_add(absolute(t), set(kTimeDoubt),
                     inverse * multiply_add(absolute(t), set(doubts.along), set(doubts.above)));
    const Floats t_low = t - off, t_high = t + off;
    const Floats old_low = load(nearest.low), old_high = load(nearest.high);
    const Mask missed = low < set(-doubts.edge);
    const Mask placed = along > set(doubts.along);  // else its depth is not known
    const Mask hit = (low > set(doubts.edge)) & placed & (t_low > set(0.0f)) & (t_high < old_low);
    const Mask beyond = placed & ((t_high < set(0.0f)) | (t_low > old_high));
    const std::uint32_t doubtful = valid & ~bits(missed | beyond | hit);
    if (HWY_UNLIKELY(doubtful != 0)) list_doubts(state, vector, doubtful, triangle);
    store(choose(hit, t_low, old_low), nearest.low);
    store(choose(hit, t_high, old_high), nearest.high);
    store_words(choose(hit, set_word(triangle), load_words(nearest.triangle)), nearest.triangle);
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
