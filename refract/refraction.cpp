// Snell's law at every corner of a grid, on the side that each facet is seen from.
#include "refract/refraction.h"

#include <cmath>
#include <optional>

#include "base/check.h"
#include "base/parallel.h"
#include "refract/snell.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 4096;  // some tens of microseconds of work

/// One corner's refracted ray on one side; a zero direction says that there is none.
Ray corner_ray(const LinearCamera& camera, const Vec3& point, const Vec3& normal_toward_eye, double eta) {
    if (normal_toward_eye == Vec3(0)) return {point, Vec3(0)};
    const std::optional<Vec3> direction =
        refracted(incident_direction(camera, point), normal_toward_eye, eta);
    return {point, direction.value_or(Vec3(0))};
}

bool seen_from_back(const SurfaceGrid& grid, const IdTriple& facet, const LinearCamera& camera) {
    return !faces_front(grid, facet, incident_direction(camera, grid.points[grid.corner_point[facet[0]]]));
}

/// Appends corners for the facets seen from the back, each grid corner once, and points those facets at them.
void append_back_corners(RayMesh& mesh, const SurfaceGrid& grid, const LinearCamera& camera, double ior) {
    std::vector<Id> back_corner(grid.corner_point.size(), kNone);
    for (IdTriple& facet : mesh.facets) {
        if (!seen_from_back(grid, facet, camera)) continue;
        for (Id& corner : facet) {
            if (back_corner[corner] == kNone) {
                back_corner[corner] = static_cast<Id>(mesh.rays.size());
                const Vec3& point = grid.points[grid.corner_point[corner]];
                mesh.rays.push_back(corner_ray(camera, point, -grid.corner_normal[corner], ior));
                mesh.screen.push_back(mesh.screen[corner]);
            }
            corner = back_corner[corner];
        }
    }
}

}  // namespace

RayMesh make_refraction(const SurfaceGrid& grid, const LinearCamera& camera, double ior) {
    TRILENS_CHECK(ior > 0 && std::isfinite(ior), "a refractive index is positive");
    const std::size_t corners = grid.corner_point.size();
    RayMesh mesh;
    mesh.rays.resize(corners);
    mesh.screen.resize(corners);
    mesh.facets = grid.facets;
    parallel_for(corners, kCornersPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const Vec3& point = grid.points[grid.corner_point[k]];
            mesh.screen[k] = screen_from_world(camera, point);
            mesh.rays[k] = corner_ray(camera, point, grid.corner_normal[k], 1 / ior);
        }
    });
    append_back_corners(mesh, grid, camera, ior);

    for (IdTriple& facet : mesh.facets) {
        for (const Id corner : IdTriple(facet)) {
            if (mesh.rays[corner].direction == Vec3(0)) facet = {kNone, kNone, kNone};
        }
    }
    return mesh;
}

}  // namespace trilens
