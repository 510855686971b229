// An explicit RayMesh as a camera's exact rays, so that optics may stand before it.
#pragma once

#include <memory>

#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"

namespace trilens {

/// The rays that the mesh interpolates are the camera's exact ones; a place without a facet has none. A point
/// may have an image in every facet, so that surface grids have no place of their own on its film: `place` is
/// none everywhere, `places` lists the images facet by facet. Screens are affine.
std::shared_ptr<const CameraModel> make_ray_mesh_model(const RayMesh& mesh, const FilmSize& film);

/// Whether a model is one of those.
bool is_ray_mesh_model(const CameraModel& model);

}  // namespace trilens
