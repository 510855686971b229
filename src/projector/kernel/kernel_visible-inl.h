// What vectors' samples see leaves the engine unplaced: exact triangles, and bounds of t.
// Included once per instruction set.
#if defined(TRILENS_KERNEL_VISIBLE_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef TRILENS_KERNEL_VISIBLE_INL_H
#undef TRILENS_KERNEL_VISIBLE_INL_H
#else
#define TRILENS_KERNEL_VISIBLE_INL_H
#endif

#include <bit>

#include "projector/kernel/kernel_resolve-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// In the scene's order what `nearest` names in the prepared one.
HWY_INLINE Words scene_triangles(const PreparedScene::Data& data, const Nearest& nearest) {
    constexpr hn::RebindToSigned<WordTag> kIndex;
    static_assert(static_cast<std::int32_t>(kNone) == -1);  // where data.named has kNone
    Words triangles = load_words(nearest.triangle);
    for (std::size_t i = 0; i < kParts; ++i)
        triangles.part[i] =
            hn::GatherIndex(kWord, data.named.data() + 1, hn::BitCast(kIndex, triangles.part[i]));
    return triangles;
}

HWY_INLINE void write_samples(const KernelScene& scene, std::uint32_t vector, const VectorVisible& visible) {
    const VectorSamples& samples = scene.tiles->samples[vector];
    const std::size_t count = static_cast<std::size_t>(std::popcount(scene.tiles->valid[vector]));
    for (std::size_t k = 0; k < count; ++k)
        scene.visible[samples.sample[k]] = {visible.triangle[k], visible.t_low[k], visible.t_high[k]};
}

/// Of a vector of the group, whose sure hits are `nearest`: decides first what is doubtful, and then
/// state.nearest is set.
template <typename FacetOf>
HWY_INLINE void write_visible(const KernelScene& scene, const KernelState& state, std::uint32_t in_group,
                              const Nearest& nearest, const FacetOf& facet_of, std::size_t& next) {
    const std::uint32_t vector = state.first_vector + in_group;
    const Words triangle = scene_triangles(*scene.data, nearest);
    const Floats low = load(nearest.low), high = load(nearest.high);
    const bool doubtful = is_doubtful(state, next, in_group);
    if (HWY_LIKELY(!doubtful && scene.visible.empty())) {
        VectorVisible& out = scene.vector_visible[vector];
        stream_words(triangle, out.triangle);
        stream(low, out.t_low);
        stream(high, out.t_high);
        return;
    }
    VectorVisible own;
    store_words(triangle, own.triangle);
    store(low, own.t_low);
    store(high, own.t_high);
    if (doubtful)
        resolve_doubts(scene, state, in_group, facet_of, next,
                       [&](std::size_t lane, const Hit& hit)
                           HWY_ATTR { set_lane(own, lane, visible_of(hit)); });
    if (!scene.vector_visible.empty()) scene.vector_visible[vector] = own;
    if (!scene.visible.empty()) write_samples(scene, vector, own);
}

/// The vectors of the tile of lane j.
HWY_INLINE void write_visible_tile(const KernelScene& scene, std::size_t j, KernelState& state,
                                   std::size_t& next) {
    const SampleTile& tile = scene.tiles->tiles[state.first_tile + j];
    const auto facet_of = [&](std::size_t)
                              HWY_ATTR -> const FacetRays& { return scene.tiles->rays[tile.rays]; };
    const std::uint32_t first = tile.first_vector - state.first_vector;
    Nearest whole;
    for (std::uint32_t i = first; i < first + tile.vectors; ++i) {
        if (is_doubtful(state, next, i)) touch_tile(scene, j, state);
        if (state.covered >> j & 1) {
            put_whole(state.whole[j], scene.tiles->vectors[state.first_vector + i], whole);
            write_visible(scene, state, i, whole, facet_of, next);
        } else {
            if (i + kPlacedAhead < state.vectors) prefetch_triangles(scene, state.nearest[i + kPlacedAhead]);
            write_visible(scene, state, i, state.nearest[i], facet_of, next);
        }
    }
}

/// What all of the group's samples see.
HWY_NOINLINE void write_visible_group(const KernelScene& scene, KernelState& state) {
    begin_doubts(state);
    std::size_t next = 0;
    for (Each lane(state.untouched & ~state.covered); lane; ++lane) set_nearest(scene, *lane, state);
    for (std::uint32_t j = state.first_lane; j < state.first_lane + state.tiles; ++j)
        write_visible_tile(scene, j, state, next);
}

/// What all samples of the mixed group's vectors that `state` names see.
HWY_NOINLINE void write_visible_mixed(const KernelScene& scene, const MixedGroup& group, KernelState& state) {
    begin_doubts(state);
    const LaneFacets* facets =
        &scene.tiles->lanes[group.first_lanes + state.first_vector - group.first_vector];
    std::size_t next = 0;
    for (std::uint32_t v = 0; v < state.vectors; ++v) {
        const auto facet_of = [&](std::size_t lane) HWY_ATTR -> const FacetRays& {
            return scene.tiles->rays[facets[v].rays[lane]];
        };
        write_visible(scene, state, v, state.nearest[v], facet_of, next);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#endif
