// A camera: its exact rays, its linear map where it has one, and its RayMesh.
#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "base/description/camera_description.h"
#include "base/raymesh/linear_camera.h"
#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"
#include "camera/model/film_axes.h"

namespace trilens {

/// Every kind of camera. `mesh` covers the part of the film that has rays. A linear camera has `linear`,
/// whose mesh is exact; another has `model`, whose mesh interpolates exact rays; a rayMesh camera has
/// neither, since its mesh is all there is.
struct Camera {
    std::optional<LinearCamera> linear;
    std::shared_ptr<const CameraModel> model;
    RayMesh mesh;
    FilmSize film;
    Vec3 axis{0};  // the view axis, world frame, unit; zero where it has none (rayMesh)
    // Clipping: rays of the mesh begin at near_depth, and what lies beyond t = far_depth - near_depth along
    // them is not seen.
    double near_depth = 0, far_depth = std::numeric_limits<double>::infinity();
};

/// The camera of a description on a film in pixels. Throws InputError at the site, with the field at fault,
/// where there is none, or where its tolerance cannot be reached with kMostCameraFacets.
Camera make_camera(const CameraDescription& from, const FilmSize& film, const CameraSite& site = {});

/// The camera's exact ray through a film place (pixels from the top left), as the limit truth follows it; of
/// a rayMesh camera its interpolated ray. None where it has none.
std::optional<Ray> exact_ray(const Camera& camera, const Vec2& at);

/// All images of a world point on the film by the camera's exact map, t >= 0 and between its clipping planes;
/// one that lies beyond the film is listed only where it is the only one. t counts from the eye or from where
/// parallel rays start. Empty for a rayMesh camera, whose images are found facet by facet.
std::vector<FilmImage> film_positions(const Camera& camera, const Vec3& point);

}  // namespace trilens
