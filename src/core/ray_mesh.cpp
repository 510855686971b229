#include "core/ray_mesh.h"

#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/rasterize.h"
#include "projector/projector.h"
#include "reflect/reflection.h"
#include "refract/refraction.h"

namespace trilens {
namespace {

bool is_finite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void require(bool holds, const char* list, std::size_t i, const char* message) {
    if (!holds) throw InputError("", fmt::format("{}/{}", list, i), message);
}

void check_grid(const SurfaceGrid& grid) {
    if (grid.corner_normal.size() != grid.corner_point.size())
        throw InputError("", "corner_normal", "needs one entry per corner");
    for (std::size_t i = 0; i < grid.points.size(); ++i)
        require(is_finite(grid.points[i]), "points", i, "is not finite");
    for (std::size_t i = 0; i < grid.corner_point.size(); ++i) {
        require(grid.corner_point[i] < grid.points.size(), "corner_point", i, "is no point");
        require(is_finite(grid.corner_normal[i]), "corner_normal", i, "is not finite");
    }
    for (std::size_t f = 0; f < grid.facets.size(); ++f)
        for (const Id corner : grid.facets[f])
            require(corner < grid.corner_point.size(), "facets", f, "has a corner that is none of the grid");
}

}  // namespace

void check_ray_mesh(const RayMesh& mesh) {
    if (mesh.screen.size() != mesh.rays.size()) throw InputError("", "screen", "needs one entry per ray");
    for (std::size_t i = 0; i < mesh.rays.size(); ++i) {
        require(is_finite(mesh.rays[i].origin) && is_finite(mesh.rays[i].direction), "rays", i,
                "is not finite");
        require(is_finite(mesh.screen[i]), "screen", i, "is not finite");
    }
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        for (const Id corner : mesh.facets[f])
            require(corner < mesh.rays.size(), "facets", f, "has a corner that is none of the mesh");
    }
}

void check_triangle_scene(const TriangleScene& scene) {
    if (scene.object.size() != scene.size()) throw InputError("", "object", "needs one entry per triangle");
    if (scene.primitive.size() != scene.size())
        throw InputError("", "primitive", "needs one entry per triangle");
    for (std::size_t i = 0; i < scene.points.size(); ++i)
        require(is_finite(scene.points[i]), "points", i, "is not finite");
    for (std::size_t t = 0; t < scene.size(); ++t)
        for (const Id corner : scene.triangles[t])
            require(corner < scene.points.size(), "triangles", t, "has a corner that is no point");
}

RayMesh make_mirror_mesh(const SurfaceGrid& grid, const LinearCamera& camera) {
    check_grid(grid);
    return make_reflection(grid, camera);
}

RayMesh make_lens_mesh(const SurfaceGrid& grid, const LinearCamera& camera, double ior) {
    check_grid(grid);
    if (!(ior > 0) || !std::isfinite(ior)) throw InputError("", "ior", "is not positive");
    return make_refraction(grid, camera, ior);
}

std::vector<Hit> draw_through(const RayMesh& mesh, const TriangleScene& scene, const SampleGrid& grid) {
    check_ray_mesh(mesh);
    check_triangle_scene(scene);
    if (grid.x0 >= grid.x1 || grid.y0 >= grid.y1 || grid.side < 1)
        throw InputError("", "grid", "has no samples");
    std::vector<Hit> hits(grid.size());
    draw(PreparedScene(scene), mesh, rasterize_facets(mesh, grid), grid, hits);
    return hits;
}

}  // namespace trilens
