// The light of volumes along rays: cells by projection of their faces, or by Embree's tree; one integral.
// Blended surfaces (glTF's alphaMode BLEND) are part of it, in their order on the ray.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "paths/trace/follow.h"
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

/// Where a leg of a path up to an optic at t = next ends for what lies in layers on its way: there, or,
/// without what lies on the optic, before it by twice the distance within which two places are one.
double up_to_optic(const Ray& ray, double next, bool has_end);

/// A leg of a path, from t = 0 to t = until.
struct LayerLeg {
    Ray ray;
    double until = 0;
    const Material* glass = nullptr;  // that it runs in; null: air
    bool has_start = true;            // what lies where it starts is on it
};

/// The light of all volumes and blended surfaces along a leg; surfaces by Embree's tree, and, where there are
/// any, cells, too. In glass volumes are none, and it dims what surfaces add by their distance.
VolumeLight trace_layers(const World& world, const LayerLeg& leg);

/// Of a path's segment, up to what it meets.
VolumeLight trace_layers(const World& world, const PathSegment& segment);

/// The rays of the samples that `owned` gives to facets, from t = 0 to until[sample].
struct LayerRays {
    const RayMesh& mesh;
    const FacetSamples& owned;
    const SampleGrid& grid;
    std::span<const double> until;         // one per sample; not positive: the sample has no such ray
    const Material* glass = nullptr;       // that they run in; null: air
    std::span<const char> has_start = {};  // one per sample, see LayerLeg; empty: all have
};

/// The light of all volumes along the interpolated ray of every sample of a facet with rays, written to
/// light[sample]; others are left alone.
using DrawVolumes = std::function<void(const LayerRays&, std::span<VolumeLight> light)>;

/// By the projector: the faces of the cells through the RayMesh, all that a sample crosses
/// (find_crossings), in each cell the nearest plane behind (CrossedCells).
DrawVolumes project_volumes(const World& world);

/// By Embree, on the same rays, with blended surfaces.
DrawVolumes trace_layers(const World& world);

/// The cells of one volume by the projector: told each sample's, from many threads.
using TakeCells = std::function<void(Id sample, const Ray& ray, const std::vector<CellStretch>& cells)>;
void project_cells(const VolumeGeometry& volume, const LayerRays& rays, const TakeCells& take);

}  // namespace trilens
