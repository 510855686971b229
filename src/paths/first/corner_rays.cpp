#include "paths/first/corner_rays.h"

#include <optional>

#include "base/util/check.h"
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

PathMesh make_environment_mesh(PathMesh path, const Vec3& centre) {
    for (Ray& ray : path.mesh.rays) ray.origin = centre;
    return path;
}

PathMesh make_flat_mesh(Path path, const SurfaceGrid& grid, std::span<const CornerView> views, double ior) {
    TRILENS_CHECK(path != Path::kDirect, "the direct path meets no optic");
    PathMesh flat{path, {}};
    for (const IdTriple& facet : grid.facets) {
        const auto point = [&](std::size_t k) { return grid.points[grid.corner_point[facet[k]]]; };
        const Vec3 front = normalize_or_zero(cross(point(1) - point(0), point(2) - point(0)));
        const Id first = static_cast<Id>(flat.mesh.rays.size());
        bool complete = front != Vec3(0);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 incident = views[facet[k]].incident;
            const bool outside = dot(incident, front) <= 0;
            std::optional<Vec3> direction;
            if (path == Path::kReflect)
                direction = mirrored(incident, front);
            else
                direction = refracted(incident, outside ? front : -front, outside ? 1 / ior : ior);
            complete = complete && direction;
            flat.mesh.rays.push_back({point(k), direction.value_or(Vec3(0))});
            flat.mesh.screen.push_back(views[facet[k]].screen);
        }
        flat.mesh.facets.push_back(complete ? IdTriple{first, first + 1, first + 2}
                                            : IdTriple{kNone, kNone, kNone});
    }
    return flat;
}

std::vector<CornerView> corner_views(const SurfaceGrid& grid, const LinearCamera& camera) {
    std::vector<CornerView> views;
    views.reserve(grid.corner_point.size());
    for (const Id point : grid.corner_point)
        views.push_back(
            {screen_from_world(camera, grid.points[point]), incident_direction(camera, grid.points[point])});
    return views;
}

}  // namespace trilens
