// The vector engine's stages put together, once per instruction set, and the choice between those.
//
// Map. Samples come in vectors of 16 of one facet, vectors in tiles, tiles of neighbouring facets in groups,
// groups in batches of at most 16 tiles (tiles/sample_tiles.h). Samples of facets too small for that share
// vectors: mixed groups.
//
// clang-format off
//
//   stage        file                  takes -> leaves
//   set-up       setup-inl.h           a batch's facets and tiles -> state.lanes: rays as functions of the
//                                      tile's (u, v), frusta; broken lanes have no bounds
//   frusta       beams-inl.h           state.lanes -> state.beam (a group), state.work.beams (its vectors)
//   walk         walk-inl.h            the tree's nodes, nearest first -> leaves that the group's beam meets;
//                                      chooses how a leaf is drawn by its cost
//   leaf modes   leaf_triangles-inl.h  lanes are the leaf's triangles, one tile at a time
//                leaf_facets-inl.h     lanes are the group's tiles, one triangle at a time
//                leaf_rays-inl.h       lanes are samples, each with its own ray
//   coverage     coverage-inl.h        a triangle over a whole tile -> state.seen.whole, or pairs of vectors
//                                      and triangles
//   filter       filter-inl.h          floats with error bounds -> state.seen.nearest (sure), .ambiguous
//   hit points   hit_points-inl.h      sure hits -> t and barycentrics with the bits of exact/hit_point.h
//   results      resolve-inl.h         ambiguous hits -> sure ones by exact/exact_hit.h, as the scalar engine
//                write-inl.h           sure hits -> one Hit per sample, or triangles with bounds of t
//   mixed groups mixed-inl.h           the same stages for vectors whose lanes have facets of their own
//
// clang-format on
//
// simd-inl.h wraps registers; state.h holds what stages hand on. A stage writes only what its line says.
// Whatever has no bounds (rays through the eye's plane, too many ambiguous hits) is left to the scalar
// engine, whose answers are the same.
#include "projector/kernel/kernel.h"

#include <algorithm>
#include <cmath>
#include <optional>

// Processors without SSE4.2 are left to the plain engine.
#if defined(__x86_64__) && !defined(HWY_BASELINE_TARGETS) && !defined(HWY_COMPILE_ONLY_STATIC)
#define HWY_BASELINE_TARGETS HWY_SSE4
#endif
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "projector/kernel/kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "projector/kernel/mixed-inl.h"
#include "projector/kernel/resolve-inl.h"
#include "projector/kernel/walk-inl.h"

HWY_BEFORE_NAMESPACE();
namespace trilens {
namespace HWY_NAMESPACE {

/// Of the vectors that `state` names, but for those of untouched tiles: nothing is seen yet.
HWY_INLINE void begin_vectors(const KernelScene& scene, std::size_t samples, KernelState& state) {
    state.seen.all_farthest = kNever;
    store(set(kNever), state.seen.farthest);
    state.seen.ambiguous.clear();
    if (scene.pixels) {
        Doubts none;
        store(set(kNever), none.low);
        state.seen.doubts.assign(state.group.vectors, none);
    }
    state.work.beams_made = false;
    state.seen.most_ambiguous = 4096 + 64 * samples;
    if (state.seen.nearest.size() < state.group.vectors) state.seen.nearest.resize(state.group.vectors);
    const SampleVector* vector = &scene.tiles->vectors[state.group.first_vector];
    const bool wait = state.seen.untouched != 0;
    for (std::uint32_t i = 0; i < state.group.vectors; ++i) {
        if (!wait) clear_nearest(state.seen.nearest[i]);
        hwy::Prefetch(vector[i].u);
        hwy::Prefetch(vector[i].v);
        if (!scene.hits.empty()) hwy::Prefetch(&scene.tiles->samples[state.group.first_vector + i]);
    }
}

HWY_INLINE void begin_group(const KernelScene& scene, const TileGroup& group, KernelState& state) {
    const SampleTile* tile = &scene.tiles->tiles[group.first];
    state.group.first_lane = group.first - state.group.first_tile;
    state.group.tiles = group.count;
    state.group.first_vector = tile[0].first_vector;
    std::size_t samples = 0;
    for (std::uint32_t i = 0; i < group.count; ++i) {
        samples += tile[i].samples;
        state.group.tile_vectors[i] = tile[i].first_vector - state.group.first_vector;
        state.group.vectors = state.group.tile_vectors[i + 1] = state.group.tile_vectors[i] + tile[i].vectors;
    }
    const SampleTile& last = tile[group.count - 1];
    state.seen.limits.resize(last.first_boxes + (last.vectors + kLanes - 1) / kLanes - tile[0].first_boxes);
    for (VectorLimits& limits : state.seen.limits) store(set(kNever), limits.farthest);
    state.seen.covered = 0;
    state.seen.untouched = first_lanes(group.count) << state.group.first_lane;
    begin_vectors(scene, samples, state);
}

/// The facets' rays of a batch: their misses wait together, not one after the other.
HWY_INLINE void prefetch_rays(const KernelScene& scene, std::uint32_t tiles, std::uint32_t first_tile) {
    for (std::uint32_t j = 0; j < tiles; ++j) {
        const char* from =
            reinterpret_cast<const char*>(&scene.tiles->rays[scene.tiles->tiles[first_tile + j].rays]);
        for (std::size_t at = 0; at < sizeof(FacetRays); at += 64) hwy::Prefetch(from + at);
        hwy::Prefetch(&scene.mesh->facets[scene.tiles->tiles[first_tile + j].facet]);
    }
}

/// Whether what is drawn goes past the caches.
HWY_INLINE bool streams(const KernelScene& scene) {
    return !scene.vector_visible.empty();
}

std::uint32_t draw_batch_here(const KernelScene& scene, std::size_t batch, const KernelOptions& options,
                              KernelState& state) {
    const TileGroup groups = scene.tiles->batches[batch];
    const TileGroup* group = &scene.tiles->groups[groups.first];
    std::uint32_t tiles = 0;
    for (std::uint32_t g = 0; g < groups.count; ++g) tiles += group[g].count;
    state.group.first_tile = group[0].first;
    state.cache.rays = kNone;
    prefetch_rays(scene, tiles, state.group.first_tile);
    set_up_batch(scene, &scene.tiles->tiles[state.group.first_tile], tiles, state.lanes);

    std::uint32_t left = state.lanes.broken & first_lanes(tiles);
    for (std::uint32_t g = 0; g < groups.count; ++g) {
        const std::uint32_t lanes = first_lanes(group[g].count) << (group[g].first - state.group.first_tile);
        if (left & lanes) {
            left |= lanes;
            continue;
        }
        begin_group(scene, group[g], state);
        state.beam.planes = 0;
        if (has_nodes(*scene.tree)) make_group_beam(scene, state, state.beam);
        const std::uint32_t middle = state.group.first_lane + state.group.tiles / 2;
        measure_pitch(state.lanes, middle, scene.tiles->tiles[state.group.first_tile + middle],
                      state.beam.pitch);
        walk_group(scene, options.leaf_mode, state);
        if (state.seen.ambiguous.size() > state.seen.most_ambiguous) {
            left |= lanes;
            continue;
        }
        if (scene.pixels)
            write_pixels_group(scene, state);
        else if (wants_visible(scene))
            write_visible_group(scene, state);
        else
            resolve_group(scene, state);
    }
    if (streams(scene)) hwy::FlushStream();
    return left;
}

/// Some vectors of a mixed group. False: they have no bounds, or too many ambiguous hits.
HWY_INLINE bool draw_mixed_vectors(const KernelScene& scene, const MixedGroup& group, std::uint32_t first,
                                   std::uint32_t count, KernelState& state) {
    state.group.first_lane = 0;
    state.group.tiles = 1;
    state.group.first_vector = group.first_vector + first;
    state.group.vectors = count;
    state.group.tile_vectors[0] = 0;
    state.group.tile_vectors[1] = count;
    state.seen.untouched = state.seen.covered = 0;
    state.seen.limits.clear();
    begin_vectors(scene, count * kLanes, state);
    if (!set_up_mixed(scene, group, state)) return false;
    walk_group(scene, LeafMode::kRays, state);
    if (state.seen.ambiguous.size() > state.seen.most_ambiguous) return false;
    if (wants_visible(scene))
        write_visible_mixed(scene, group, state);
    else
        resolve_mixed(scene, group, state);
    return true;
}

std::uint32_t draw_mixed_here(const KernelScene& scene, std::size_t number, KernelState& state) {
    const MixedGroup& group = scene.tiles->mixed[number];
    std::uint32_t left = 0;
    if (!draw_mixed_vectors(scene, group, 0, group.vectors, state)) {
        for (std::uint32_t v = 0; v < group.vectors; ++v)
            left |= draw_mixed_vectors(scene, group, v, 1, state) ? 0 : 1u << v;
    }
    if (streams(scene)) hwy::FlushStream();
    return left;
}

}  // namespace HWY_NAMESPACE
}  // namespace trilens
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace trilens {
namespace {

HWY_EXPORT(draw_batch_here);
HWY_EXPORT(draw_mixed_here);

struct NamedTarget {
    const char* name;
    std::int64_t target;
};
constexpr NamedTarget kTargets[] = {
    {"avx512", HWY_AVX3}, {"avx2", HWY_AVX2}, {"sse4.2", HWY_SSE4}, {"neon", HWY_NEON}};

}  // namespace

std::uint32_t draw_batch(const KernelScene& scene, std::size_t batch, const KernelOptions& options,
                         KernelState& state) {
    return HWY_DYNAMIC_DISPATCH(draw_batch_here)(scene, batch, options, state);
}

std::uint32_t draw_mixed(const KernelScene& scene, std::size_t group, KernelState& state) {
    return HWY_DYNAMIC_DISPATCH(draw_mixed_here)(scene, group, state);
}

std::vector<std::string> kernel_instruction_sets() {
    std::vector<std::string> names;
    for (const NamedTarget& t : kTargets) {
        if (hwy::SupportedTargets() & HWY_TARGETS & t.target) names.push_back(t.name);
    }
    return names;
}

bool use_instruction_set(const std::string& name) {
    hwy::SetSupportedTargetsForTest(0);
    if (name.empty()) {
        hwy::GetChosenTarget().DeInit();
        return true;
    }
    for (const NamedTarget& t : kTargets) {
        if (name != t.name || !(hwy::SupportedTargets() & HWY_TARGETS & t.target)) continue;
        hwy::SetSupportedTargetsForTest(t.target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        return true;
    }
    return false;
}

}  // namespace trilens
#endif
