// The mirror law at every corner of a grid.
#include "reflect/reflection.h"

#include "base/parallel.h"
#include "reflect/mirror.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 4096;  // some tens of microseconds of work

bool has_ray(const RayMesh& mesh, Id corner) {
    return mesh.rays[corner].direction != Vec3(0);
}

}  // namespace

RayMesh make_reflection(const SurfaceGrid& grid, const LinearCamera& camera) {
    const std::size_t corners = grid.corner_point.size();
    RayMesh mesh;
    mesh.rays.resize(corners);
    mesh.screen.resize(corners);
    parallel_for(corners, kCornersPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const Vec3& point = grid.points[grid.corner_point[k]];
            const Vec3& normal = grid.corner_normal[k];
            mesh.screen[k] = screen_from_world(camera, point);
            mesh.rays[k].origin = point;
            if (normal == Vec3(0)) continue;
            mesh.rays[k].direction = mirrored(incident_direction(camera, point), normal);
        }
    });

    mesh.facets.reserve(grid.facets.size());
    for (const IdTriple& facet : grid.facets) {
        const bool complete = has_ray(mesh, facet[0]) && has_ray(mesh, facet[1]) && has_ray(mesh, facet[2]);
        mesh.facets.push_back(complete ? facet : IdTriple{kNone, kNone, kNone});
    }
    return mesh;
}

}  // namespace trilens
