// The path of the camera's ray through a film place, over the exact optics of a fit.
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "inverse/fit/fit_scene.h"
#include "inverse/fit/path_word.h"

namespace trilens {

/// One meeting with an optic.
struct OpticEvent {
    std::size_t optic = 0;  // of FitScene::optics
    Id face = kNone;
    Vec2 uv{0};
    SurfacePoint as_built;  // of the optic's surface as built, with second derivatives
    SurfacePoint point;     // world
    bool reflects = true;
    Id before = kNone, after = kNone;  // optics whose glass the light runs in; kNone: air
};

/// A path from the camera: its events, and the ray that leaves the last of them.
struct ShotPath {
    Ray view;  // the camera's ray, unit direction
    std::vector<OpticEvent> events;
    Ray last;  // unit direction
    /// Per number of events k: the ray after k of them, and how far it goes to the next event.
    std::vector<Ray> after;
    std::vector<double> reach;
};

/// The refractive index of the glass of an optic; 1 of air.
double index_of(const FitScene& scene, Id medium);

/// The path of the ray through `pixel` that the word describes; with an empty word the one that mirrors
/// reflect and glass transmits, or reflects totally, to its end. The camera stands in air. None where the
/// camera has no ray there, or where the ray does not meet what the word says.
std::optional<ShotPath> shoot_path(const FitScene& scene, const Camera& camera, const Vec2& pixel,
                                   const PathWord& word);

/// Keeps the first `count` events.
void cut_path(ShotPath& path, std::size_t count);

/// Where the last ray passes nearest to a point: in front of where it starts.
Vec3 nearest_on_last(const ShotPath& path, const Vec3& point);

/// Of the numbers of events after which the light runs in air, or of all, the one whose ray passes nearest
/// to the point before it meets the next optic.
std::size_t events_towards(const ShotPath& path, const Vec3& point);

}  // namespace trilens
