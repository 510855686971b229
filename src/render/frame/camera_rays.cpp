#include "render/frame/camera_rays.h"

#include <algorithm>

#include "base/util/parallel.h"
#include "render/frame/ray_mesh_model.h"

namespace trilens {
namespace {

bool has_optics(const Scene& scene) {
    return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                       [](const Mesh& mesh) { return mesh.role == Role::kOptic; });
}

}  // namespace

CameraRays make_camera_rays(const Scene& scene, std::size_t index) {
    const CameraDescription& from = scene.cameras[index];
    const FilmSize film{static_cast<double>(scene.film.width), static_cast<double>(scene.film.height)};
    CameraRays camera = make_camera(from, film, {scene.file, "/cameras/" + std::to_string(index)});
    if (from.type == CameraType::kRayMesh && has_optics(scene))
        camera.model = make_ray_mesh_model(camera.mesh, film);
    return camera;
}

FacetSamples set_exact_rays(const CameraModel& model, const SampleGrid& grid, std::span<SampleView> views) {
    std::vector<Id> owner(grid.size(), kNone);
    parallel_for(owner.size(), 256, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s) {
            const std::optional<Ray> ray = model.ray(grid.position(s));
            if (!ray) continue;
            views[s].ray = *ray;
            owner[s] = 0;
        }
    });
    return group_by_facet(owner, 1);
}

void count_from_eye(const CameraRays& camera, std::span<SampleView> views) {
    if (camera.near_depth == 0) return;
    for (SampleView& view : views)
        if (view.hit.seen() || view.optic != kNone) view.depth += camera.near_depth;
}

}  // namespace trilens
