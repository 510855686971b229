// The thesis' engine: outlines of projected triangles, filled and depth-buffered (Vallance 2005, chapters 3
// to 5).
#pragma once

#include <span>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "projector/classic/classic_params.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

/// The contract of draw(), but for coverage: a sample sees a triangle where the triangle's outlines in the
/// sample's facet hold it, so a sample beyond its facet's border may see nothing. A sample exactly on an
/// outline goes by the rule that facets go by; triangles with the same vertices along an edge leave no gap
/// there. Slices put a shared edge's vertices at other places for each of its triangles, and may leave some.
/// t and the barycentrics are those of the sample's ray in the triangle's plane; where a coarse outline
/// reaches beyond the triangle, those of a point on the triangle's border.
/// With Clip::kUnclipped every facet projects every triangle.
void draw_classic(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                  const SampleGrid& grid, std::span<Hit> hits, const ClassicParams& params);

}  // namespace trilens
