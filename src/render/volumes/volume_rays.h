// The light of volumes along rays: cells by projection of their faces, or by Embree's tree; one integral.
// Blended surfaces (glTF's alphaMode BLEND) are part of it, in their order on the ray.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "render/world/world.h"
#include "volume/cell_faces.h"

namespace trilens {

inline bool has_volumes(const World& world) {
    return !world.volumes.empty();
}

/// Whether anything that lets light through in part may stand between what is seen and where it is seen from.
inline bool has_layers(const World& world) {
    return has_volumes(world) || world.blended;
}

/// The cells of a volume that a ray passes between t = 0 and t = until (t in units of its direction;
/// infinity: to the end), in order of where it comes in. Truth: every cell whose box Embree's tree finds on
/// the ray, clipped against its planes.
std::vector<CellStretch> trace_cells(const VolumeGeometry& volume, const Ray& ray, double until);

/// The light of all volumes along a ray, its cells by trace_cells.
VolumeLight trace_volumes(const World& world, const Ray& ray, double until);

/// The light of all volumes and blended surfaces along a ray; surfaces by Embree's tree, and, where there are
/// any, cells, too.
VolumeLight trace_layers(const World& world, const Ray& ray, double until);

/// The light of all volumes along the interpolated ray of every sample that `owned` gives to a facet with
/// rays, from t = 0 to until[sample], written to light[sample]; others are left alone, as are samples whose
/// `until` is not positive. until.size() == light.size() == grid.size().
using DrawVolumes = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&,
                                       std::span<const double> until, std::span<VolumeLight> light)>;

/// By the projector: the faces of the cells through the RayMesh, all that a sample crosses
/// (find_crossings), in each cell the nearest plane behind (CrossedCells).
DrawVolumes project_volumes(const World& world);

/// By Embree, on the same rays, with blended surfaces.
DrawVolumes trace_layers(const World& world);

/// The cells of one volume by the projector: told each sample's, from many threads.
using TakeCells = std::function<void(Id sample, const Ray& ray, const std::vector<CellStretch>& cells)>;
void project_cells(const VolumeGeometry& volume, const RayMesh& mesh, const FacetSamples& owned,
                   const SampleGrid& grid, std::span<const double> until, const TakeCells& take);

}  // namespace trilens
