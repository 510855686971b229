// Where moving points of the world appear on a film over an optic, as values of a map with their derivatives.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "inverse/maps/sampled_map.h"
#include "paths/trace/path.h"
#include "render/frame/request.h"

namespace trilens {

struct World;

/// A point of the world at a pixel of a map, and how it moves with the pixel's x and y.
struct WorldPlace {
    Vec3 point{0}, dx{0}, dy{0};
};

struct FilmImagesParams {
    FrameParams frame;
    std::optional<std::size_t> optic;           // index into World::optics: the first on the way; none: any
    std::optional<Path> path;                   // none: reflected by mirrors, refracted by glass
    bool objects_hide =
        false;                 // what lies between the last optic (or the eye, directly) and a place hides it
    bool beyond_film = false;  // keep images beyond the film's edges; with objects_hide none
    const std::atomic<bool>* cancel = nullptr;  // Progress::cancel
};

/// images[i] gets the images of places[i] that lie on the film (or beyond it), on that way, on the exact
/// surfaces, which nothing before the last optic hides, and that carry light; none for a place that is none.
/// Derivatives are exact where `project` has them, else differences over half a pixel of the map; zero where
/// not even these are known. Throws Interrupted once it is cancelled.
void find_film_images(const World& world, const FilmImagesParams& params,
                      std::span<const std::optional<WorldPlace>> places, std::span<MapImages> images);

}  // namespace trilens
