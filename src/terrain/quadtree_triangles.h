// Triangles of a restricted quadtree over a square of heights, cut at the grid's last column and row.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "terrain/height_square.h"

namespace trilens {

/// A corner: a sample, or where a side crosses the grid's last column or row.
struct GridPlace {
    double column = 0, row = 0;
    double height = 0;  // the file's value
};

struct GridTriangles {
    std::vector<GridPlace> places;
    std::vector<IdTriple> triangles;  // fronts upwards
};

/// Whether the triangulation has a sample that halves a square's diagonal or a square's side; with it, it has
/// the samples that it rests on.
using KeptSample = std::function<bool(int x, int y)>;

/// How many triangles there will be before those at the last column and row are cut.
std::size_t count_triangles(const HeightSquare& heights, const KeptSample& is_kept);

/// Each square whose middle is kept is a fan around it: each side whole or, where its middle is kept, in
/// halves, and where a quarter's own middle is kept it is a square of its own. Squares next to each other
/// share the middles of their sides, so that there are no cracks. Triangles with a corner at a missing sample
/// are left out.
GridTriangles cut_triangles(const HeightSquare& heights, const KeptSample& is_kept);

}  // namespace trilens
