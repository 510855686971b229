// The scalar engine: one ray at a time through a bounding volume hierarchy, with the exact hit per triangle.
// What the vector engine is tested against, and what it turns to where it has no bounds.
#pragma once

#include <span>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "projector/exact/exact_hit.h"
#include "projector/scene/prepared_scene.h"

namespace trilens {

/// What draw() does, in double throughout. `cull` false: every ray is offered every triangle; the same hits.
void draw_scalar(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                 const SampleGrid& grid, std::span<Hit> hits, bool cull);

/// What the ray of one sample sees first. `ray`: from `centre`, times its weight (FacetRays::at).
Hit first_hit_of(const PreparedScene::Data& scene, const SampleRay& ray, const Vec3& centre);

}  // namespace trilens
