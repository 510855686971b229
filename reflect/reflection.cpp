// The mirror law at every corner of a grid.
#include "reflect/reflection.h"

#include "base/util/check.h"
#include "base/util/parallel.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 4096;  // some tens of microseconds of work

bool has_ray(const RayMesh& mesh, Id corner) {
    return mesh.rays[corner].direction != Vec3(0);
}

/// `view_of(k)`: the camera's view of corner k.
template <typename ViewOf>
RayMesh reflect_corners(const SurfaceGrid& grid, const ViewOf& view_of) {
    const std::size_t corners = grid.corner_point.size();
    RayMesh mesh;
    mesh.rays.resize(corners);
    mesh.screen.resize(corners);
    parallel_for(corners, kCornersPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const CornerView view = view_of(k);
            const Vec3& normal = grid.corner_normal[k];
            mesh.screen[k] = view.screen;
            mesh.rays[k].origin = grid.points[grid.corner_point[k]];
            if (normal == Vec3(0)) continue;
            mesh.rays[k].direction = mirrored(view.incident, normal);
        }
    });

    mesh.facets.reserve(grid.facets.size());
    for (const IdTriple& facet : grid.facets) {
        const bool complete = has_ray(mesh, facet[0]) && has_ray(mesh, facet[1]) && has_ray(mesh, facet[2]);
        mesh.facets.push_back(complete ? facet : IdTriple{kNone, kNone, kNone});
    }
    return mesh;
}

}  // namespace

RayMesh make_reflection(const SurfaceGrid& grid, const LinearCamera& camera) {
    return reflect_corners(grid, [&](std::size_t k) {
        const Vec3& point = grid.points[grid.corner_point[k]];
        return CornerView{screen_from_world(camera, point), incident_direction(camera, point)};
    });
}

RayMesh make_reflection(const SurfaceGrid& grid, std::span<const CornerView> views) {
    TRILENS_CHECK(views.size() == grid.corner_point.size(), "one view per corner");
    return reflect_corners(grid, [&](std::size_t k) { return views[k]; });
}

}  // namespace trilens
