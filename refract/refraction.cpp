// Snell's law at every corner of a grid, on the side that each facet is seen from.
#include "refract/refraction.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/util/check.h"
#include "base/util/parallel.h"

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

std::optional<Vec3> refracted(const Vec3& incoming, const Vec3& unit_normal, double eta) {
    const double size = length(incoming);
    if (!(size > 0)) return std::nullopt;
    const Vec3 unit = incoming / size;

    // The part along the surface. A ray beyond grazing is laid into the surface first.
    const double cosine = -dot(unit, unit_normal);
    Vec3 along = unit + cosine * unit_normal;
    if (cosine < 0) along = normalize_or_zero(along);
    if (cosine < 0 && along == Vec3(0)) return std::nullopt;
    const Vec3 tangential = eta * along;
    const double sin2 = dot(tangential, tangential);
    if (sin2 > 1) return std::nullopt;
    const Vec3 direction = tangential - std::sqrt(1 - sin2) * unit_normal;
    return direction * (size / length(direction));
}

bool is_beyond_critical(double cos_incident, double eta) {
    const double cosine = std::clamp(cos_incident, 0.0, 1.0);
    return eta * eta * (1 - cosine * cosine) > 1;
}

double fresnel_reflectance(double cos_incident, double eta) {
    if (eta == 1) return 0;  // and no rounding, which would be followed as a path
    const double cos_i = std::clamp(cos_incident, 0.0, 1.0);
    const double sin2 = eta * eta * (1 - cos_i * cos_i);
    if (sin2 >= 1) return 1;
    const double cos_t = std::sqrt(1 - sin2);

    // Amplitudes for the field parallel and at right angles to the plane of incidence; light is half of each.
    const double parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return 0.5 * (parallel * parallel + perpendicular * perpendicular);
}

}  // namespace trilens
