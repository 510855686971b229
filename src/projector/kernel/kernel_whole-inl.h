// Tiles that one triangle covers wholly: kept as such until another triangle may be seen there too.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_WHOLE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_WHOLE_INL_H
#undef TRILENS_KERNEL_WHOLE_INL_H
#else
#define TRILENS_KERNEL_WHOLE_INL_H
#endif

#include <cmath>

#include "projector/kernel/kernel_forms-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

HWY_INLINE void clear_nearest(Nearest& nearest) {
    store(set(kNever), nearest.low);
    store(set(kNever), nearest.high);
    store_words(set_word(kNone), nearest.triangle);
}

/// At the vector's samples.
HWY_INLINE void put_whole(const WholeTile& whole, const SampleVector& samples, Nearest& nearest) {
    const Floats u = load(samples.u), v = load(samples.v);
    const auto linear = [&](const float(&c)[3]) HWY_ATTR {
        return multiply_add(u, set(c[1]), multiply_add(v, set(c[2]), set(c[0])));
    };
    const Floats inverse = reciprocal(linear(whole.along)), t = linear(whole.above) * inverse;
    const Floats off = doubt_of_time(t, inverse, set(whole.above_doubt), set(whole.along_doubt));
    store(t - off, nearest.low);
    store(t + off, nearest.high);
    store_words(set_word(whole.triangle), nearest.triangle);
}

HWY_NOINLINE void set_nearest(const KernelScene& scene, std::size_t j, KernelState& state) {
    state.untouched &= ~(1u << j);
    const bool covered = state.covered >> j & 1;
    const std::size_t k = j - state.first_lane;
    for (std::uint32_t i = state.tile_vectors[k]; i < state.tile_vectors[k + 1]; ++i) {
        if (covered)
            put_whole(state.whole[j], scene.tiles->vectors[state.first_vector + i], state.nearest[i]);
        else
            clear_nearest(state.nearest[i]);
    }
    state.covered &= ~(1u << j);
}

/// Before `nearest` of the vectors of the tile of lane j is used.
HWY_INLINE void touch_tile(const KernelScene& scene, std::size_t j, KernelState& state) {
    if (state.untouched >> j & 1) set_nearest(scene, j, state);
}

/// What is known of a triangle's depth over a whole tile: least <= t <= most, if `known`.
struct WholeDepth {
    bool known = false;
    float least = 0, most = 0;
};

/// Of forms' lane, if every ray of the tile surely meets the triangle's plane in front of it.
HWY_INLINE WholeDepth whole_depth(const Forms& forms, std::size_t lane, const TileDoubts& doubts) {
    const auto swing = [lane](const float(&c)[3][kLanes])
                           HWY_ATTR { return std::fabs(c[1][lane]) + std::fabs(c[2][lane]); };
    const float along_swing = swing(forms.along), above_swing = swing(forms.above);
    const float slowest = forms.along[0][lane] - along_swing, fastest = forms.along[0][lane] + along_swing;
    const float lowest = forms.above[0][lane] - above_swing, highest = forms.above[0][lane] + above_swing;
    if (!(slowest > kSureDepth * doubts.along && lowest > kSureDepth * doubts.above)) return {};
    return {true, (1 - kDepthRound) * (lowest - doubts.above) / (fastest + doubts.along),
            (1 + kDepthRound) * (highest + doubts.above) / (slowest - doubts.along)};
}

/// A triangle, whose forms are in `lane`, over the tile of lane `tile`.
struct TileTriangle {
    const Forms& forms;
    std::size_t lane;
    std::uint32_t triangle;  // index into PreparedScene::Data
    std::size_t tile;
};

/// Takes note that the triangle covers the tile, which is untouched.
HWY_INLINE void cover_tile(const TileTriangle& t, const TileDoubts& doubts, const WholeDepth& depth,
                           KernelState& state) {
    WholeTile& whole = state.whole[t.tile];
    whole.triangle = t.triangle;
    for (int p = 0; p < 3; ++p) {
        whole.above[p] = t.forms.above[p][t.lane];
        whole.along[p] = t.forms.along[p][t.lane];
    }
    whole.above_doubt = doubts.above;
    whole.along_doubt = doubts.along;
    whole.farthest = depth.most;
    state.covered |= 1u << t.tile;
}

/// Whether the triangle needs no look at the tile's vectors, because it covers an empty tile or lies behind
/// the triangle that covers it. `whole`: all samples of the tile are surely inside it.
HWY_INLINE bool is_settled(const TileTriangle& t, const TileDoubts& doubts, bool whole, KernelState& state) {
    if (!(state.untouched >> t.tile & 1)) return false;
    const bool covered = state.covered >> t.tile & 1;
    if (!covered && !whole) return false;
    const WholeDepth depth = whole_depth(t.forms, t.lane, doubts);
    if (!depth.known) return false;
    if (covered) return depth.least > state.whole[t.tile].farthest;
    cover_tile(t, doubts, depth, state);
    return true;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
