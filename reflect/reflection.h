// The law of reflection, and a surface grid's corner rays mirrored.
#pragma once

#include <span>

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"

namespace trilens {

// What a camera sees in a mirror: the surface grid's corners with mirrored rays, as a RayMesh (thesis,
// chapter 7).

/// The RayMesh of `grid` seen by `camera`: corner k and facet f of the mesh are corner k and facet f of the
/// grid. A corner ray starts at the grid point; its direction is the mirrored incident direction with the
/// incident one's length (eye to corner; 1 for parallel cameras), which keeps a flat mirror exact: all its
/// rays meet in the virtual eye at t = -1. The mirror is two-sided: the side that faces the camera reflects.
/// A facet with a corner that has no normal, or that the eye lies on, gets no rays.
RayMesh make_reflection(const SurfaceGrid& grid, const LinearCamera& camera);

/// The same for any camera, which sees each corner of the grid as `views` say.
RayMesh make_reflection(const SurfaceGrid& grid, std::span<const CornerView> views);

// The mirror law for one ray.

/// The direction of the mirrored ray: d - 2 (d . n) n. Keeps the length of `incoming` (which points TO the
/// surface and need not be unit); `unit_normal` may point to either side.
inline Vec3 mirrored(const Vec3& incoming, const Vec3& unit_normal) {
    return incoming - 2.0 * dot(incoming, unit_normal) * unit_normal;
}

}  // namespace trilens
