// A camera: its exact rays, its linear map where it has one, and its RayMesh; what its facets, or those of a
// mirror, are among the general linear cameras.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <optional>

#include "base/description/camera_description.h"
#include "base/raymesh/ray_mesh.h"
#include "camera/model/camera_model.h"
#include "camera/model/general_linear.h"

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

// What the facets of a camera, or of a mirror, are among the general linear cameras.

/// The kind that a facet's three corner rays make between planes across `axis` (world frame, any length), or,
/// where that is zero or one of the rays does not go its way, across the mean of their unit directions. None
/// where the facet has no rays, two of them are one, or they go opposite ways. Throws
/// InputError (place "facet") for a facet that the mesh does not have, or whose corners it does not have.
std::optional<GeneralLinearKind> facet_kind(const RayMesh& mesh, std::size_t facet, const Vec3& axis = {});

/// How many facets of a mesh are of which kind. What counts them throws InputError as check_ray_mesh does.
struct FacetKinds {
    std::array<std::size_t, kGeneralLinearKindCount> of_kind{};  // by GeneralLinearKind
    std::size_t without = 0;                                     // of no kind

    std::size_t count(GeneralLinearKind kind) const { return of_kind[static_cast<std::size_t>(kind)]; }
};
FacetKinds facet_kinds(const RayMesh& mesh, const Vec3& axis = {});

/// Of a camera's own facets, across its view axis.
FacetKinds facet_kinds(const Camera& camera);

}  // namespace trilens
