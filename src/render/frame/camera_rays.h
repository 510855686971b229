// A camera's exact rays, also those of an explicit RayMesh.
#pragma once

#include <memory>
#include <span>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/parallel.h"
#include "camera/camera.h"
#include "camera/model/camera_model.h"
#include "render/frame/views.h"
#include "scene/data/scene.h"

namespace trilens {

/// A scene's camera: its exact rays, its linear map where it has one, and its RayMesh.
using CameraRays = Camera;

/// The camera `index` of the scene; an explicit RayMesh has a model (ray_mesh_model.h) where the scene has
/// optics, whose grids then lie on its film. Throws InputError with its place where it is none.
CameraRays make_camera_rays(const Scene& scene, std::size_t index);

/// Calls use(sample, facet, ray) with the camera's ray of every sample that `owned` gives to a facet, from
/// several threads.
template <typename Use>
void for_each_camera_ray(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid, Use&& use) {
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        const std::span<const Id> samples = owned.of(f);
        parallel_for(samples.size(), 1024, [&](std::size_t from, std::size_t to) {
            for (const Id s : samples.subspan(from, to - from))
                use(s, static_cast<Id>(f), sample_ray(mesh, f, weights, grid.position(s)));
        });
    }
}

/// Sets the exact ray of every sample of a camera that is not linear, and returns the samples that have one
/// (those of facet 0), ascending. For the limit truth.
FacetSamples set_exact_rays(const CameraModel& model, const SampleGrid& grid, std::span<SampleView> views);

/// Adds the depth at which the camera's rays begin to the depths of what is seen.
void count_from_eye(const CameraRays& camera, std::span<SampleView> views);

/// The rays that the mesh interpolates are the camera's exact ones; a place without a facet has none. A point
/// may have an image in every facet, so that surface grids have no place of their own on its film: `place` is
/// none everywhere, `places` lists the images facet by facet. Screens are affine.
std::shared_ptr<const CameraModel> make_ray_mesh_model(const RayMesh& mesh, const FilmSize& film);

/// Whether a model is one of those.
bool is_ray_mesh_model(const CameraModel& model);

}  // namespace trilens
