#include "render/camera_rays.h"

#include <algorithm>

#include "base/error.h"
#include "base/parallel.h"
#include "camera/perspective.h"

namespace trilens {
namespace {

void refuse_optics(const Scene& scene, std::size_t index) {
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].role != Role::kOptic) continue;
        throw InputError(
            scene_title(scene), "/cameras/" + std::to_string(index),
            "a rayMesh camera shows objects only, but mesh \"" + scene.meshes[m].name + "\" is an optic");
    }
}

}  // namespace

CameraRays make_camera_rays(const Scene& scene, std::size_t index) {
    const CameraDescription& from = scene.cameras[index];
    const int width = scene.film.width, height = scene.film.height;
    CameraRays camera;
    if (from.type == CameraDescription::Type::kRayMesh) {
        refuse_optics(scene, index);
        camera.mesh =
            make_ray_mesh({from.points, from.directions, from.screen, from.triangles}, width, height);
        return camera;
    }
    PerspectiveParams params;
    params.look_at = {from.eye, from.at, from.up};
    params.yfov_degrees = from.yfov;
    params.width = width;
    params.height = height;
    camera.linear = make_perspective(params);
    camera.mesh = make_camera_mesh(*camera.linear, width, height);
    return camera;
}

void set_camera_rays(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                     std::span<SampleView> views) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        const std::span<const Id> samples = owned.of(f);
        parallel_for(samples.size(), 1024, [&](std::size_t from, std::size_t to) {
            for (const Id s : samples.subspan(from, to - from))
                views[s].ray = sample_ray(mesh, f, weights, grid.position(s));
        });
    }
}

}  // namespace trilens
