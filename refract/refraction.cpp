// Snell's law at every corner of a grid, on the side that each facet is seen from.
#include "refract/refraction.h"

#include <cmath>
#include <optional>

#include "base/util/check.h"
#include "base/util/parallel.h"
#include "refract/dielectric.h"

namespace trilens {
namespace {

constexpr std::size_t kCornersPerTask = 4096;  // some tens of microseconds of work

/// One corner's refracted ray on one side; a zero direction says that there is none.
Ray corner_ray(const Vec3& incident, const Vec3& point, const Vec3& normal_toward_eye, double eta) {
    if (normal_toward_eye == Vec3(0)) return {point, Vec3(0)};
    const std::optional<Vec3> direction = refracted(incident, normal_toward_eye, eta);
    return {point, direction.value_or(Vec3(0))};
}

/// Appends corners for the facets seen from the back, each grid corner once, and points those facets at them.
/// `view_of(k)`: the camera's view of corner k.
template <typename ViewOf>
void append_back_corners(RayMesh& mesh, const SurfaceGrid& grid, const ViewOf& view_of, double ior) {
    std::vector<Id> back_corner(grid.corner_point.size(), kNone);
    for (IdTriple& facet : mesh.facets) {
        if (faces_front(grid, facet, view_of(facet[0]).incident)) continue;
        for (Id& corner : facet) {
            if (back_corner[corner] == kNone) {
                back_corner[corner] = static_cast<Id>(mesh.rays.size());
                const Vec3& point = grid.points[grid.corner_point[corner]];
                mesh.rays.push_back(
                    corner_ray(view_of(corner).incident, point, -grid.corner_normal[corner], ior));
                mesh.screen.push_back(mesh.screen[corner]);
            }
            corner = back_corner[corner];
        }
    }
}

template <typename ViewOf>
RayMesh refract_corners(const SurfaceGrid& grid, const ViewOf& view_of, double ior) {
    TRILENS_CHECK(ior > 0 && std::isfinite(ior), "a refractive index is positive");
    const std::size_t corners = grid.corner_point.size();
    RayMesh mesh;
    mesh.rays.resize(corners);
    mesh.screen.resize(corners);
    mesh.facets = grid.facets;
    parallel_for(corners, kCornersPerTask, [&](std::size_t first, std::size_t last) {
        for (std::size_t k = first; k < last; ++k) {
            const Vec3& point = grid.points[grid.corner_point[k]];
            const CornerView view = view_of(k);
            mesh.screen[k] = view.screen;
            mesh.rays[k] = corner_ray(view.incident, point, grid.corner_normal[k], 1 / ior);
        }
    });
    append_back_corners(mesh, grid, view_of, ior);

    for (IdTriple& facet : mesh.facets) {
        for (const Id corner : IdTriple(facet)) {
            if (mesh.rays[corner].direction == Vec3(0)) facet = {kNone, kNone, kNone};
        }
    }
    return mesh;
}

}  // namespace

RayMesh make_refraction(const SurfaceGrid& grid, const LinearCamera& camera, double ior) {
    const auto view_of = [&](std::size_t k) {
        const Vec3& point = grid.points[grid.corner_point[k]];
        return CornerView{screen_from_world(camera, point), incident_direction(camera, point)};
    };
    return refract_corners(grid, view_of, ior);
}

RayMesh make_refraction(const SurfaceGrid& grid, std::span<const CornerView> views, double ior) {
    TRILENS_CHECK(views.size() == grid.corner_point.size(), "one view per corner");
    return refract_corners(
        grid, [&](std::size_t k) { return views[k]; }, ior);
}

}  // namespace trilens
