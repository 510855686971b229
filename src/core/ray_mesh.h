// RayMeshes of other programs: their data checked, then drawn through.
#pragma once

#include <vector>

#include "base/linear_camera.h"
#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "base/surface.h"
#include "base/triangle_scene.h"
#include "camera/perspective.h"
#include "trilinear/mesh_point_images.h"

namespace trilens {

/// What the camera sees in a mirror whose surface is this grid (Vallance 2005, chapter 7): the grid's corners
/// with mirrored rays; facet f is facet f of the grid. Throws InputError where the grid's arrays do not fit
/// together.
RayMesh make_mirror_mesh(const SurfaceGrid& grid, const LinearCamera& camera);

/// What it sees through one interface, `ior` being the refractive index behind the grid's front over that
/// before it. Facets that lie partly in total reflection have no rays. Throws InputError likewise, and for an
/// `ior` that is not positive.
RayMesh make_lens_mesh(const SurfaceGrid& grid, const LinearCamera& camera, double ior);

/// For each sample of `grid` the first triangle along its ray, exact on edges, the same for any number of
/// threads: an unset hit where nothing is seen or no facet covers the sample. Where facets overlap on the
/// screen the one with the smaller index has the sample. Throws InputError where mesh or scene do not fit
/// together: indices out of range, numbers that are not finite, an empty grid.
std::vector<Hit> draw_through(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid);

/// Throws InputError with the place of the first thing that makes it no RayMesh.
void check_ray_mesh(const RayMesh& mesh);

/// Likewise for triangles.
void check_triangle_scene(const TriangleScene& scene);

}  // namespace trilens
