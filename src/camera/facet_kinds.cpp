#include "camera/facet_kinds.h"

#include "base/raymesh/check_data.h"
#include "base/util/error.h"

namespace trilens {

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
