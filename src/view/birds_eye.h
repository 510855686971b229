// A second view of the scene, from outside: the scene, the first camera, and the paths of light as lines.
#pragma once

#include <trilens/render.h>
#include <trilens/scene.h>

#include <span>
#include <vector>

#include "view/painter.h"
#include "view/session.h"

namespace trilens {

/// The camera of the bird's-eye view as a scene's JSON has cameras.
Json birds_eye_camera(const Scene& scene, const BirdsEye& from);

/// Where rays of the film's corners and of its middle are, at that distance from where they start, and behind
/// each where it starts: ten points, fewer where the camera has no such rays.
std::vector<Vec3> camera_corners(const Renderer& renderer, std::size_t camera, double distance);

/// The objects that lie between a place and any of some targets, as a mirror's front wall does, each once;
/// optics that are met first hide nothing. Ids as in Scene::meshes.
std::vector<Id> objects_before(const Renderer& renderer, const Vec3& from, std::span<const Vec3> targets);

/// The scene that the bird's-eye view shows: without objects that stand before the first camera, the middles
/// of the optics and the corners of the paths. Its optics are those of the scene, in the same order.
Scene birds_eye_scene(const Renderer& renderer, std::size_t camera, const std::vector<PathLine>* pixel_paths,
                      const PlaceImages* place_images);

struct BirdsEyeRequest {
    std::size_t camera = 0;                                       // whose view is explained
    double reach = 10;                                            // scene_reach
    const std::vector<PathLine>* pixel_paths = nullptr;           // may be null
    const PlaceImages* place_images = nullptr;                    // may be null
    const std::vector<LineDrawing::Caustic>* caustics = nullptr;  // may be null
    ToneMapping tone;
};

/// Draws with the last camera of a birds_eye_scene on its film. `corners`: camera_corners on the first
/// camera's film.
ShownBirdsEye draw_birds_eye(const Renderer& renderer, const BirdsEyeRequest& request,
                             const std::vector<Vec3>& corners, const Progress& progress);

}  // namespace trilens
