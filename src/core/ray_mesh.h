// RayMeshes of other programs: their data checked, then drawn through.
#pragma once

#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/surface.h"
#include "base/raymesh/triangle_scene.h"
#include "camera/linear/linear_cameras.h"
#include "trilinear/points/point_images.h"

namespace trilens {

/// What the camera sees in a mirror whose surface is this grid (Vallance 2005, chapter 7): the grid's corners
/// with mirrored rays; facet f is facet f of the grid. Throws InputError where the grid's arrays do not fit
/// together, or numbers of the grid or the camera are not finite or beyond kLargestNumber
/// (base/raymesh/sample_grid.h).
RayMesh make_mirror_mesh(const SurfaceGrid& grid, const LinearCamera& camera);

/// What it sees through one interface, `ior` being the refractive index behind the grid's front over that
/// before it. Facets that lie partly in total reflection have no rays. Throws InputError likewise, and for an
/// `ior` that is not positive.
RayMesh make_lens_mesh(const SurfaceGrid& grid, const LinearCamera& camera, double ior);

/// For each sample of `grid` the first triangle along its ray, exact on edges, the same for any number of
/// threads: an unset hit where nothing is seen or no facet covers the sample. Where facets overlap on the
/// screen the one with the smaller index has the sample. Throws InputError as check_ray_mesh,
/// check_triangle_scene and check_sample_grid do, and for more samples than this machine's memory
/// holds.
std::vector<Hit> draw_through(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid);

/// The triangles of draw_through()'s hits, by the same exact decisions, with proven bounds of their t: most
/// often a ten-thousandth of it apart, more where rays graze the triangle. For those who need no place on the
/// triangle: in less time and memory. Throws as draw_through does.
std::vector<Visible> visible_through(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid);

}  // namespace trilens
