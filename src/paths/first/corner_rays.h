// The RayMeshes that leave an optic: its grid's corners with their rays after the optic.
#pragma once

#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/surface.h"
#include "paths/trace/path.h"

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

/// The usual approximations, as rivals of the projection.

/// Environment mapping: the same rays, but all from one place, `centre` (world): what is near shows no
/// parallax. Source: Blinn and Newell, Texture and Reflection in Computer Generated Images, 1976.
PathMesh make_environment_mesh(PathMesh path, const Vec3& centre);

/// Flat facets, the usual polygon mirror: every facet reflects or refracts by the normal of its plane, so
/// that it has corners of its own. Facets without area or with total reflection have no rays. Arguments as
/// make_path_mesh has them.
PathMesh make_flat_mesh(Path path, const SurfaceGrid& grid, std::span<const CornerView> views, double ior);

/// How a linear camera sees each corner of the grid.
std::vector<CornerView> corner_views(const SurfaceGrid& grid, const LinearCamera& camera);

}  // namespace trilens
