// How many pixels of the pictures that show a terrain a unit of its height is worth: a quadtree, refined
// where that changes.
#pragma once

#include <cstddef>
#include <vector>

#include "base/description/film_move.h"
#include "base/util/error.h"
#include "terrain/height_square.h"

namespace trilens {

/// Each cell of the quadtree is asked for at its corners, lowest and highest, and in its middle; it is
/// divided where the answers differ, where a film's border passes, and where a cell beside it is seen and it
/// is not. A cell is worth the most that was found, times the ratio by which the answers differ still, at
/// most two. So it holds for all places where the scale does not leap between two samples; that is not
/// proven.
class FilmScale {
  public:
    /// Cells are no smaller than this share of the square's side.
    static constexpr int kMostLevels = 7;

    /// `moves`: of places of the terrain's own frame. Throws Interrupted once `progress` says so.
    FilmScale(const HeightSquare& heights, const SampleSpacing& frame, const FilmMoves& moves,
              const Progress& progress = {});

    /// Pixels per unit of y, the most of all places less than `half` samples from (x, y), along both axes;
    /// both multiples of `half`, which is a power of 2.
    double most_around(int x, int y, int half) const;

  private:
    class Refinement;
    double cell(int level, int i, int j) const;

    int levels_ = 0, samples_ = 1;           // of the finest cells; samples along one of their sides
    std::vector<std::vector<double>> most_;  // per level from the coarsest, row by row
};

}  // namespace trilens
