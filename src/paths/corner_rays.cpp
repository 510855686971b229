#include "paths/corner_rays.h"

#include "base/check.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"

namespace trilens {

PathMesh make_path_mesh(Path path, const SurfaceGrid& grid, const LinearCamera& camera, double ior) {
    TRILENS_CHECK(path != Path::kDirect, "the direct path meets no optic");
    if (path == Path::kReflect) return {path, make_reflection(grid, camera)};
    return {path, make_refraction(grid, camera, ior)};
}

PathMesh make_path_mesh(Path path, const SurfaceGrid& grid, std::span<const CornerView> views, double ior) {
    TRILENS_CHECK(path != Path::kDirect, "the direct path meets no optic");
    if (path == Path::kReflect) return {path, make_reflection(grid, views)};
    return {path, make_refraction(grid, views, ior)};
}

}  // namespace trilens
