// A scene's camera as a RayMesh, with its linear map where it has one.
#pragma once

#include <optional>
#include <span>

#include "base/facet_samples.h"
#include "base/linear_camera.h"
#include "base/ray_mesh.h"
#include "base/sample_grid.h"
#include "render/views.h"
#include "scene/scene.h"

namespace trilens {

struct CameraRays {
    std::optional<LinearCamera> linear;  // none for an explicit RayMesh
    RayMesh mesh;
};

/// The camera `index` of the scene. Throws InputError where it is a RayMesh and the scene has optics: their
/// grids have no place on a nonlinear screen.
CameraRays make_camera_rays(const Scene& scene, std::size_t index);

/// Sets the camera's ray of every sample that `owned` gives to a facet.
void set_camera_rays(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                     std::span<SampleView> views);

}  // namespace trilens
