// The exact engine: the vector engine over tiles of samples, and the scalar one where it finds no bounds.
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <memory>
#include <mutex>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "projector/kernel/state.h"
#include "projector/projector.h"
#include "projector/scalar/scalar_engine.h"
#include "projector/scene/bvh.h"

namespace trilens {
namespace {

/// What lane k of a vector sees, to all who ask for it.
void put_hit(const KernelScene& scene, std::uint32_t vector, std::size_t k, const Hit& seen) {
    const Id sample = scene.tiles->samples[vector].sample[k];
    if (!scene.hits.empty()) scene.hits[sample] = seen;
    if (!scene.visible.empty()) scene.visible[sample] = visible_of(seen);
    if (!scene.vector_visible.empty()) set_lane(scene.vector_visible[vector], k, visible_of(seen));
}

/// The samples of one vector that the vector engine has no bounds for. `rays_of`: of a lane.
template <typename RaysOf>
void draw_vector_scalar(const KernelScene& scene, std::uint32_t vector, const RaysOf& rays_of) {
    for (std::size_t k = 0; k < kLanes; ++k) {
        if (!(scene.tiles->valid[vector] >> k & 1)) continue;
        const FacetRays& facet = scene.tiles->rays[rays_of(k)];
        const Vec2 position = scene.grid->position(scene.tiles->samples[vector].sample[k]);
        put_hit(scene, vector, k, first_hit_of(*scene.data, facet.at(position), facet.centre));
    }
}

/// A thread's own, kept from one call to the next.
KernelState& own_state() {
    thread_local const std::unique_ptr<KernelState> state = std::make_unique<KernelState>();
    return *state;
}
SampleTiles& own_tiles() {
    thread_local SampleTiles tiles;
    return tiles;
}

void clear(SampleTiles& tiles) {
    tiles.rays.clear();
    tiles.tiles.clear();
    tiles.groups.clear();
    tiles.batches.clear();
    tiles.mixed.clear();
    tiles.lanes.clear();
    tiles.vectors.clear();
    tiles.samples.clear();
    tiles.valid.clear();
    tiles.boxes.clear();
    tiles.slot.clear();
}

/// Samples of these vectors.
std::size_t samples_in(const SampleTiles& tiles, std::uint32_t first, std::uint32_t count) {
    std::size_t samples = 0;
    for (std::uint32_t v = first; v < first + count; ++v)
        samples += static_cast<std::size_t>(std::popcount(tiles.valid[v]));
    return samples;
}

/// Pixels of these vectors: nothing is sure.
void leave_open(const KernelScene& scene, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t v = first; v < first + count; ++v)
        for (std::size_t k = 0; k < kLanes; ++k)
            scene.visible[scene.tiles->samples[v].sample[k]].triangle = kSeveral;
}

DrawCounts draw_one_batch(const KernelScene& scene, std::size_t batch, const KernelOptions& options) {
    KernelState& state = own_state();
    state.seen.ambiguous_samples = 0;
    const std::uint32_t left = draw_batch(scene, batch, options, state);
    DrawCounts counts{state.seen.ambiguous_samples, 0};
    const TileGroup& groups = scene.tiles->batches[batch];
    const std::uint32_t first_tile = scene.tiles->groups[groups.first].first;
    for (std::uint32_t j = 0; j < kLanes; ++j) {
        if (!(left >> j & 1)) continue;
        const SampleTile& tile = scene.tiles->tiles[first_tile + j];
        if (scene.pixels) {
            leave_open(scene, tile.first_vector, tile.vectors);
            continue;
        }
        for (std::uint32_t v = tile.first_vector; v < tile.first_vector + tile.vectors; ++v)
            draw_vector_scalar(scene, v, [&](std::size_t) { return tile.rays; });
        counts.unbounded += samples_in(*scene.tiles, tile.first_vector, tile.vectors);
    }
    return counts;
}

DrawCounts draw_one_mixed(const KernelScene& scene, std::size_t number) {
    KernelState& state = own_state();
    state.seen.ambiguous_samples = 0;
    const std::uint32_t left = draw_mixed(scene, number, state);
    DrawCounts counts{state.seen.ambiguous_samples, 0};
    const MixedGroup& group = scene.tiles->mixed[number];
    for (std::uint32_t v = 0; v < kLanes; ++v) {
        if (!(left >> v & 1)) continue;
        draw_vector_scalar(scene, group.first_vector + v,
                           [&](std::size_t k) { return scene.tiles->lanes[group.first_lanes + v].rays[k]; });
        counts.unbounded += samples_in(*scene.tiles, group.first_vector + v, 1);
    }
    return counts;
}

/// What is drawn, but for what is asked for.
KernelScene kernel_scene(const PreparedScene& scene, const RayMesh& mesh, const SampleGrid& grid) {
    return {.data = &scene.data(), .tree = &scene.data().leaves, .mesh = &mesh, .grid = &grid};
}

void check_samples(const RayMesh& mesh, const FacetSamples& owned) {
    TRILENS_CHECK(owned.first.size() == mesh.facets.size() + 1,
                  "the samples must be grouped by the mesh's facets");
}

/// Draws what `asked` asks for, by sample, but for its tiles: a batch's vectors are made, drawn and forgotten
/// while they are in cache.
void draw_vectors(const KernelScene& asked, const FacetSamples& owned, const DrawOptions& options) {
    const TilePlan plan =
        plan_tiles(*asked.mesh, owned, *asked.grid, options.tiles.value_or(tile_params(asked.data->size())));
    const std::size_t batches = plan.batches.size();
    parallel_for(batches + plan.mixed_groups.size(), 1, [&](std::size_t first, std::size_t last) {
        TileMaker maker(*asked.grid);
        SampleTiles& tiles = own_tiles();
        KernelScene kernel = asked;
        kernel.tiles = &tiles;
        for (std::size_t b = first; b < last; ++b) {
            clear(tiles);
            if (b < batches) {
                maker.add_batch(plan, b, tiles);
                draw_one_batch(kernel, 0, options.kernel);
            } else {
                maker.add_mixed(plan, b - batches, tiles);
                draw_one_mixed(kernel, 0);
            }
        }
    });
}

/// The pixels that are asked for, whose facets `owned` tells: as draw_vectors().
void draw_pixels(const KernelScene& asked, const FacetSamples& owned) {
    constexpr int kPixelsAcrossTile = 16;
    SampleGrid pixels = *asked.grid;
    pixels.side = 1;
    TileParams params = tile_params(asked.data->size());
    params.tile_side = kPixelsAcrossTile;
    params.mixed_below = 0;
    const TilePlan plan = plan_tiles(*asked.mesh, owned, pixels, params);
    std::mutex mutex;
    parallel_for(plan.batches.size(), 1, [&](std::size_t first, std::size_t last) {
        TileMaker maker(pixels, asked.grid->side);
        SampleTiles& tiles = own_tiles();
        std::vector<PixelTriangle> open;
        KernelScene kernel = asked;
        kernel.tiles = &tiles;
        if (asked.open) kernel.open = &open;
        for (std::size_t b = first; b < last; ++b) {
            clear(tiles);
            maker.add_batch(plan, b, tiles);
            draw_one_batch(kernel, 0, {});
        }
        if (open.empty()) return;
        const std::lock_guard lock(mutex);
        asked.open->insert(asked.open->end(), open.begin(), open.end());
    });
    if (!asked.open) return;
    std::sort(asked.open->begin(), asked.open->end(), [](const PixelTriangle& a, const PixelTriangle& b) {
        return a.pixel != b.pixel ? a.pixel < b.pixel : a.triangle < b.triangle;
    });
    const auto same = [](const PixelTriangle& a, const PixelTriangle& b) {
        return a.pixel == b.pixel && a.triangle == b.triangle;
    };
    asked.open->erase(std::unique(asked.open->begin(), asked.open->end(), same), asked.open->end());
}

}  // namespace

DrawCounts draw_tiles(const KernelScene& scene, const KernelOptions& options) {
    std::atomic<std::size_t> ambiguous = 0, unbounded = 0;
    const std::size_t batches = scene.tiles->batches.size();
    parallel_for(batches + scene.tiles->mixed.size(), 1, [&](std::size_t first, std::size_t last) {
        DrawCounts own;
        for (std::size_t b = first; b < last; ++b) {
            const DrawCounts counts =
                b < batches ? draw_one_batch(scene, b, options) : draw_one_mixed(scene, b - batches);
            own.ambiguous += counts.ambiguous;
            own.unbounded += counts.unbounded;
        }
        // Locked additions wait for the hits on their way to memory.
        if (own.ambiguous > 0) ambiguous += own.ambiguous;
        if (own.unbounded > 0) unbounded += own.unbounded;
    });
    return {ambiguous, unbounded};
}

void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits, const DrawOptions& options) {
    TRILENS_CHECK(hits.size() == grid.size(), "one hit per sample of the grid");
    check_samples(mesh, owned);
    if (!options.vectors || !options.cull) return draw_scalar(scene, mesh, owned, grid, hits, options.cull);
    KernelScene asked = kernel_scene(scene, mesh, grid);
    asked.hits = hits;
    draw_vectors(asked, owned, options);
}

void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits) {
    draw(scene, mesh, owned, grid, hits, DrawOptions{});
}

void find_visible(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Visible> visible, const DrawOptions& options) {
    TRILENS_CHECK(visible.size() == grid.size(), "one entry per sample of the grid");
    check_samples(mesh, owned);
    TRILENS_CHECK(options.vectors && options.cull, "only the vector engine leaves hits unplaced");
    KernelScene asked = kernel_scene(scene, mesh, grid);
    asked.visible = visible;
    draw_vectors(asked, owned, options);
}

void find_visible(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Visible> visible) {
    find_visible(scene, mesh, owned, grid, visible, DrawOptions{});
}

void find_visible_by_pixel(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                           const SampleGrid& grid, std::span<Visible> visible,
                           std::vector<PixelTriangle>* open) {
    TRILENS_CHECK(visible.size() == grid.pixels(), "one entry per pixel of the grid");
    TRILENS_CHECK(grid.side > 1 && grid.chosen.empty(), "a pixel has several samples, all of them");
    check_samples(mesh, owned);
    KernelScene asked = kernel_scene(scene, mesh, grid);
    asked.visible = visible;
    asked.pixels = true;
    asked.open = open;
    draw_pixels(asked, owned);
}

}  // namespace trilens
