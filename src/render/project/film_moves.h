// How the images of points move on the films of a scene's cameras: what terrains are thinned by.
#pragma once

#include "base/description/film_move.h"
#include "scene/data/scene.h"

namespace trilens {

/// Of all cameras of the scene and all images that its optics make, those left out that an optic hides, not
/// those that an object hides. Copies what it needs. Thread-safe; a call uses all threads. Throws InputError
/// where a cage cannot be used.
FilmMoves film_moves(const Scene& scene);

}  // namespace trilens
