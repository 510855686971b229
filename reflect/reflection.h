// What a camera sees in a mirror: the surface grid's corners with mirrored rays, as a RayMesh (thesis,
// chapter 7).
#pragma once

#include <span>

#include "base/raymesh/linear_camera.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"

namespace trilens {

/// The RayMesh of `grid` seen by `camera`: corner k and facet f of the mesh are corner k and facet f of the
/// grid. A corner ray starts at the grid point; its direction is the mirrored incident direction with the
/// incident one's length (eye to corner; 1 for parallel cameras), which keeps a flat mirror exact: all its
/// rays meet in the virtual eye at t = -1. The mirror is two-sided: the side that faces the camera reflects.
/// A facet with a corner that has no normal, or that the eye lies on, gets no rays.
RayMesh make_reflection(const SurfaceGrid& grid, const LinearCamera& camera);

/// The same for any camera, which sees each corner of the grid as `views` say.
RayMesh make_reflection(const SurfaceGrid& grid, std::span<const CornerView> views);

}  // namespace trilens
