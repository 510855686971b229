// How far what cameras show moves on their films where a point of the world moves a little.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/math/vec.h"

namespace trilens {

/// A place that stands for all places no farther from it than `reach`.
struct FilmMoveQuery {
    Vec3 place{0};
    Vec3 along{0};  // what it moves by
    double reach = 0;
};

struct FilmMove {
    // The most pixels that any image of the place, direct or over optics, moves by, to first order; of those
    // images alone that are on their film or as near to it as the reach may bring them. Infinite at a fold,
    // and where it is not known.
    double pixels = 0;
    bool is_shown = false;  // there is such an image
    bool is_whole = false;  // and one on the film itself
};

/// One answer per query.
using FilmMoves = std::function<std::vector<FilmMove>(std::span<const FilmMoveQuery> queries)>;

}  // namespace trilens
