#include "render/volumes/volume_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/parallel.h"
#include "projector/scalar/scalar_engine.h"
#include "render/world/blended_surfaces.h"
#include "render/world/volume_geometry.h"
#include "shade/shade.h"

namespace trilens {
namespace {

constexpr std::size_t kVolumeRaysPerTask = 64;

RayThroughVolume through(const World& world, std::size_t volume, const Ray& ray,
                         std::span<const CellStretch> cells) {
    const VolumeGeometry& geometry = *world.volumes[volume];
    return {&world.scene.volumes[volume].transfer,
            scalars_along(geometry.cells(), geometry.gradients(), ray, cells)};
}

}  // namespace

std::vector<CellStretch> trace_cells(const VolumeGeometry& volume, const Ray& ray, double until) {
    std::vector<CellStretch> cells;
    volume.cell_boxes().visit(ray, 0, until, [&](Id cell) {
        if (const std::optional<CellStretch> stretch = clip_line(volume.cells(), cell, ray))
            if (stretch->t_out > 0 && stretch->t_in < until) cells.push_back(*stretch);
        return until;
    });
    order_cells(until, cells);
    return cells;
}

VolumeLight trace_volumes(const World& world, const Ray& ray, double until) {
    std::vector<RayThroughVolume> rays;
    for (std::size_t v = 0; v < world.volumes.size(); ++v)
        rays.push_back(through(world, v, ray, trace_cells(*world.volumes[v], ray, until)));
    return integrate(rays);
}

void project_cells(const VolumeGeometry& volume, const LayerRays& rays, const TakeCells& take) {
    const CrossedCells crossed(volume.cells(), volume.faces());
    find_crossings(volume.prepared_faces(), rays.mesh, rays.owned, rays.grid, rays.until,
                   [&](Id sample, const Ray& ray, std::span<const Crossing> crossings) {
                       std::vector<FaceCrossing> faces;
                       faces.reserve(crossings.size());
                       for (const Crossing& one : crossings) faces.push_back({one.triangle, one.t});
                       take(sample, ray, crossed.find(ray, rays.until[sample], faces));
                   });
}

DrawVolumes project_volumes(const World& world) {
    return [&world](const LayerRays& of, std::span<VolumeLight> light) {
        if (of.glass) return;
        const SampleGrid& grid = of.grid;
        if (world.volumes.size() == 1) {
            project_cells(*world.volumes[0], of,
                          [&](Id sample, const Ray& ray, const std::vector<CellStretch>& cells) {
                              const RayThroughVolume one = through(world, 0, ray, cells);
                              light[sample] = integrate({&one, 1});
                          });
            return;
        }
        std::vector<std::vector<RayThroughVolume>> rays(grid.size());
        for (std::size_t v = 0; v < world.volumes.size(); ++v)
            project_cells(*world.volumes[v], of,
                          [&](Id sample, const Ray& ray, const std::vector<CellStretch>& cells) {
                              rays[sample].push_back(through(world, v, ray, cells));
                          });
        parallel_for(rays.size(), kVolumeRaysPerTask, [&](std::size_t from, std::size_t to) {
            for (std::size_t s = from; s < to; ++s)
                if (!rays[s].empty()) light[s] = integrate(rays[s]);
        });
    };
}

namespace {

/// What glass leaves of the light of the surfaces in it.
void dim_by_glass(const Material& glass, const Ray& ray, std::span<const Hit> crossings,
                  std::span<VolumeLight> surfaces) {
    const double unit = length(ray.direction);
    for (std::size_t i = 0; i < surfaces.size(); ++i)
        surfaces[i].emission *= volume_transmittance(glass, crossings[i].t * unit);
}

}  // namespace

double up_to_optic(const Ray& ray, double next, bool has_end) {
    if (has_end || !std::isfinite(next)) return next;
    return next - 2 * same_place(ray.origin + next * ray.direction) / length(ray.direction);
}

VolumeLight trace_layers(const World& world, const LayerLeg& leg) {
    const Ray& ray = leg.ray;
    const Material* glass = leg.glass;
    const double until = leg.until;
    if (!world.blended) return glass ? VolumeLight() : trace_volumes(world, ray, until);
    const std::vector<Hit> crossings = leg.has_start ? world.blended->crossings(ray, until)
                                                     : world.blended->crossings_after_start(ray, until);
    std::vector<VolumeLight> surfaces = world.blended->shade(ray, crossings);
    if (glass) dim_by_glass(*glass, ray, crossings, surfaces);
    VolumeLight sum;
    double from = 0;
    const auto add_cells = [&](double to) {
        if (has_volumes(world) && !glass && to > from)
            sum.put_behind(
                trace_volumes(world, {ray.origin + from * ray.direction, ray.direction}, to - from));
        from = to;
    };
    for (std::size_t i = 0; i < crossings.size(); ++i) {
        add_cells(crossings[i].t);
        sum.put_behind(surfaces[i]);
    }
    add_cells(until);
    return sum;
}

VolumeLight trace_layers(const World& world, const PathSegment& segment) {
    const Material* glass = glass_of(world, segment.medium);
    const double until = !segment.ends ? up_to_optic(segment.ray, segment.next, !glass || segment.to_mirror)
                         : segment.hit.seen() ? segment.hit.t
                                              : std::numeric_limits<double>::infinity();
    return trace_layers(world, {segment.ray, until, glass, segment.has_start});
}

DrawVolumes trace_layers(const World& world) {
    return [&world](const LayerRays& of, std::span<VolumeLight> light) {
        const RayMesh& mesh = of.mesh;
        for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
            if (!mesh.has_rays(f) || of.owned.of(f).empty()) continue;
            const FacetWeights weights = facet_weights(mesh, f);
            if (weights.edge_on) continue;
            const std::span<const Id> samples = of.owned.of(f);
            parallel_for(samples.size(), kVolumeRaysPerTask, [&](std::size_t from, std::size_t to) {
                for (const Id s : samples.subspan(from, to - from))
                    if (of.until[s] > 0)
                        light[s] = trace_layers(
                            world, {sample_ray(mesh, f, weights, of.grid.position(s)), of.until[s], of.glass,
                                    of.has_start.empty() || of.has_start[s]});
            });
        }
    };
}

}  // namespace trilens
