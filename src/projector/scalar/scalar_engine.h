// The scalar engine: one ray at a time through a bounding volume hierarchy, with the exact hit per triangle.
// What the vector engine is tested against, and what it turns to where it has no bounds.
#pragma once

#include <functional>
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

/// A triangle that a sample's ray crosses.
struct Crossing {
    Id triangle = kNone;  // index into the scene
    double t = 0;         // in units of the ray's direction, >= 0
};

/// Told what one sample crosses, from many threads at once, each sample by one of them.
using TakeCrossings = std::function<void(Id sample, const Ray& ray, std::span<const Crossing>)>;

/// Every triangle along the facet's interpolated ray, by the decisions of draw(), for every sample that
/// `owned` gives to a facet with rays and an area on the screen, and whose until[sample] > 0: those with
/// 0 <= t <= until[sample], in order of t, then of the scene's triangles; where there are none and the ray
/// starts within the scene's bounds, the first one behind, alone, or nothing. `ray`: the sample's.
/// until.size() == grid.size().
void find_crossings(const PreparedScene& scene, const RayMesh& mesh, const FacetSamples& owned,
                    const SampleGrid& grid, std::span<const double> until, const TakeCrossings& take);

}  // namespace trilens
