#include "camera/camera.h"

#include <algorithm>
#include <cmath>

#include "base/raymesh/rasterize.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "camera/linear/linear_cameras.h"
#include "camera/model/film_mesh.h"
#include "camera/model/models.h"

namespace trilens {
namespace {

RayMesh fine_mesh(const ModelSource& source, const CameraModel& model) {
    const double tolerance = source.from.tolerance;
    if (!(tolerance > 0))
        return make_film_mesh(model, source.film,
                              source.from.facets > 0 ? source.from.facets : kDefaultCameraFacets);
    TolerantMesh found = make_film_mesh_within(model, source.film, tolerance, kMostCameraFacets);
    if (!found.mesh)
        source.site.reject(
            "tolerance",
            fmt::format("{} pixels cannot be reached: {:.3g} are left at pixel {:.1f}, {:.1f} "
                        "with {} x {} facets, the most there may be",
                        tolerance, found.error.pixels, found.error.at.x, found.error.at.y, found.n, found.n));
    return std::move(*found.mesh);
}

}  // namespace

ModelPointer make_model(const ModelSource& source) {
    return std::visit(
        [&]<typename Kind>(const Kind& kind) -> ModelPointer {
            if constexpr (kIsLinear<Kind>) return make_linear_model(source);
            if constexpr (kChoosesFacets<Kind>) return make_model(kind, source);
            return nullptr;
        },
        source.from.kind);
}

Camera make_camera(const CameraDescription& from, const FilmSize& film, const CameraSite& site) {
    require_film(film.width, film.height, site);
    Camera camera;
    camera.film = film;
    if (const auto* rays = std::get_if<RayMeshCamera>(&from.kind)) {
        camera.mesh = make_ray_mesh({rays->points, rays->directions, rays->screen, rays->triangles},
                                    film.width, film.height);
        return camera;
    }
    if (is_linear(from)) {
        const LinearView view = make_linear_view(from, film, site);
        camera.linear = view.camera;
        camera.axis = view.camera.view_axis != Vec3(0) ? view.camera.view_axis : view.camera.view_direction;
        camera.near_depth = view.near_depth;
        camera.far_depth = view.far_depth;
        camera.mesh = make_camera_mesh(view.camera, film.width, film.height, view.near_depth);
        return camera;
    }
    if (from.facets < 0 || from.facets > kMostCameraFacets)
        site.reject("facets", fmt::format("is not in 1..{}", kMostCameraFacets));
    const ModelSource source{from, film, site};
    camera.model = make_model(source);
    camera.axis = normalize(from.at - from.eye);
    camera.mesh = fine_mesh(source, *camera.model);
    return camera;
}

std::optional<Ray> exact_ray(const Camera& camera, const Vec2& at) {
    if (camera.model) return camera.model->ray(at);
    if (camera.linear) {
        Ray ray = film_ray(*camera.linear, at);
        ray.origin += camera.near_depth * ray.direction;
        return ray;
    }
    for (std::size_t f = 0; f < camera.mesh.facets.size(); ++f) {
        const FacetWeights weights = facet_weights(camera.mesh, f);
        if (weights.edge_on) continue;
        const Vec3 e = weights.unnormalised(at.x, at.y);
        if (std::min({e.x, e.y, e.z}) >= 0) return sample_ray(camera.mesh, f, weights, at);
    }
    return std::nullopt;
}

std::vector<FilmImage> film_positions(const Camera& camera, const Vec3& point) {
    if (camera.model) return film_images(*camera.model, camera.film, point);
    if (!camera.linear) return {};
    const Vec3 screen = screen_from_world(*camera.linear, point);
    if (!(screen.z > 0)) return {};
    const Vec2 pixel = Vec2(screen.x, screen.y) / screen.z;
    const Ray ray = film_ray(*camera.linear, pixel);
    const double t = camera.linear->parallel
                         ? dot(point - ray.origin, ray.direction) / dot(ray.direction, ray.direction)
                         : screen.z;
    if (!(t >= camera.near_depth && t <= camera.far_depth)) return {};
    return {{pixel, t, ray.origin}};
}

std::optional<GeneralLinearKind> facet_kind(const RayMesh& mesh, std::size_t facet, const Vec3& axis) {
    if (facet >= mesh.facets.size()) throw InputError("", "facet", "is none of the mesh");
    if (!mesh.has_rays(facet)) return std::nullopt;
    for (const Id corner : mesh.facets[facet])
        if (corner >= mesh.rays.size())
            throw InputError("", "facet", "has a corner that is none of the mesh");
    std::array<Ray, 3> rays;
    Vec3 mean(0);
    for (std::size_t k = 0; k < 3; ++k) {
        rays[k] = mesh.rays[mesh.facets[facet][k]];
        mean += normalize_or_zero(rays[k].direction);
    }
    std::optional<GeneralLinearCamera> camera = general_linear_camera(rays, axis);
    if (!camera) camera = general_linear_camera(rays, mean);
    if (!camera) return std::nullopt;
    return camera->kind;
}

FacetKinds facet_kinds(const RayMesh& mesh, const Vec3& axis) {
    check_ray_mesh(mesh);
    FacetKinds kinds;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const std::optional<GeneralLinearKind> kind = facet_kind(mesh, f, axis);
        ++(kind ? kinds.of_kind[static_cast<std::size_t>(*kind)] : kinds.without);
    }
    return kinds;
}

FacetKinds facet_kinds(const Camera& camera) {
    return facet_kinds(camera.mesh, camera.axis);
}

}  // namespace trilens
