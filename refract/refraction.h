// What a camera sees through one interface: the surface grid's corners with refracted rays, as a RayMesh
// (thesis, chapter 7).
#pragma once

#include <span>

#include "base/raymesh/linear_camera.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// The RayMesh of `grid` seen by `camera` through the surface alone: one refraction, after which the rays go
/// on in the other medium. `ior`: index of the medium behind the surface's front over that before it
/// (glass: 1.5), > 0.
///
/// Facet f of the mesh is facet f of the grid. Its side is decided by its flat triangle: turned to the camera
/// by its front, rays go in (eta = 1 / ior); by its back, they come out (eta = ior). A corner may be needed
/// on both sides, so corner k of the mesh is the grid's corner k for facets seen from the front, and corners
/// for facets seen from the back follow after them, one per grid corner in use. Directions keep the incident
/// length, as in make_reflection.
///
/// A corner whose normal is turned beyond grazing (near the silhouette) counts as grazing. A facet gets no
/// rays where one of its corners has no normal, lies in the eye, or reflects totally.
RayMesh make_refraction(const SurfaceGrid& grid, const LinearCamera& camera, double ior);

/// The same for any camera, which sees each corner of the grid as `views` say.
RayMesh make_refraction(const SurfaceGrid& grid, std::span<const CornerView> views, double ior);

}  // namespace trilens
