// The RayMeshes that leave an optic: its grid's corners with their rays after the optic.
#pragma once

#include <span>
#include <vector>

#include "base/corner_view.h"
#include "base/linear_camera.h"
#include "base/ray_mesh.h"
#include "base/surface.h"
#include "paths/path.h"

namespace trilens {

/// The RayMesh of one path. Facet f is facet f of the grid.
struct PathMesh {
    Path path = Path::kReflect;
    RayMesh mesh;
};

/// The grid seen by the camera after one event at the optic: make_reflection or make_refraction. `ior`: of
/// kRefract, as make_refraction has it. Not for kDirect.
PathMesh make_path_mesh(Path path, const SurfaceGrid& grid, const LinearCamera& camera, double ior);

/// The same for any camera, which sees each corner of the grid as `views` say.
PathMesh make_path_mesh(Path path, const SurfaceGrid& grid, std::span<const CornerView> views, double ior);

}  // namespace trilens
