// Draws a scene through a RayMesh: the exact engine.
#pragma once

#include <optional>
#include <span>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "projector/kernel/kernel.h"
#include "projector/scene/prepared_scene.h"
#include "projector/tiles/sample_tiles.h"

namespace trilens {

/// For every sample that `owned` gives to a facet with rays and an area on the screen: the first triangle
/// along the facet's interpolated ray (t >= 0), written to hits[sample]; other entries of `hits` are left
/// alone. hits.size() == grid.size(). A sample need not lie inside its facet: the weights are extrapolated.
/// Coverage is exact (conic edge functions, mathematics section 2) and watertight across triangles that share
/// an edge or a corner by its coordinates. Ties in depth go by kDepthTie, whatever the order of the scene's
/// triangles. The same hits for any number of threads.
void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits);

/// As draw(), of the same samples: which triangle each sees, and bounds of its t, by the same exact
/// decisions, but not where on the triangle. Takes less time and memory.
void find_visible(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Visible> visible);

/// For every pixel of the grid's window that `owned` gives to a facet, by its number in rows: what
/// find_visible() would find for each of its samples by that facet's rays, where that is surely one triangle,
/// or nothing, with bounds of t that hold for all of them; else `triangle` is kSeveral. visible.size() ==
/// grid.pixels(); other entries are left alone. Takes about as long as for one sample a pixel. `open`: if
/// asked for, gets all triangles that the samples of pixels with kSeveral may see, by pixel; of some pixels
/// none are known.
void find_visible_by_pixel(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                           const SampleGrid& grid, std::span<Visible> visible,
                           std::vector<PixelTriangle>* open = nullptr);

// Switches of the exact engine that tests and benchmarks turn; none changes a bit of what it draws.

struct DrawOptions {
    bool vectors = true;  // false: one ray at a time, in double
    bool cull = true;     // false: every ray is offered every triangle, slowly
    KernelOptions kernel{};
    std::optional<TileParams> tiles{};  // none: tile_params() of the scene
};

void draw(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
          std::span<Hit> hits, const DrawOptions& options);

/// Of `options` the vector engine's.
void find_visible(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Visible> visible, const DrawOptions& options);

}  // namespace trilens
