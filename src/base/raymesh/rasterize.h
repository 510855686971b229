// Which facet of a RayMesh each sample of the film shows.
#pragma once

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"

namespace trilens {

/// The facets' samples by the top-left rule on the screen: a sample on an edge or a corner that facets share
/// belongs to exactly one of them, also where corners are duplicated and where some lie behind the camera (w
/// <= 0). For meshes that do not fold over on the screen (cameras); where they do, the facet with the smaller
/// index wins. Facets without rays or without area on the screen own nothing.
FacetSamples rasterize_facets(const RayMesh& mesh, const SampleGrid& grid);

}  // namespace trilens
