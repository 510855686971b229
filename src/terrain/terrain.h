// Terrain: triangles of a quadtree over a grid of heights, without cracks, thinned by wavelets.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "base/image/height_grid.h"
#include "base/math/vec.h"
#include "base/util/ids.h"
#include "terrain/thinning.h"

namespace trilens {

/// Each takes about 200 bytes before it is drawn, and 500 while it is traced.
inline constexpr std::size_t kMostTerrainTriangles = 40'000'000;

struct TerrainShape {
    Vec3 size{1};                   // along x and z of the whole grid; along y of a value of 1
    std::optional<double> no_data;  // a number of the file that is no height
};

struct Thinning {
    ThinningRule rule = ThinningRule::kBound;
    double threshold = 0;  // in y, or in pixels where `moves` is given; what matters no more goes
    std::optional<InterestRegion> region;
    FilmMoves moves = {};  // of places of the terrain's own frame
};

/// In its own frame: x to the right of the grid's rows, z down its columns, both from the middle; y up.
struct TerrainMesh {
    std::vector<Vec3> points;
    std::vector<Vec3> normals;        // unit, per point: of central differences of the whole grid
    std::vector<Vec2> uvs;            // per point: (0, 0) at the grid's bottom left, (1, 1) at its top right
    std::vector<IdTriple> triangles;  // fronts upwards

    std::size_t missing_heights = 0;
    std::size_t whole_triangles = 0;  // that the whole grid has, without holes
    // How far, along y, the triangles are from those of the whole grid: at the worst place, and in the mean
    // of squares over the samples.
    double greatest_error = 0, rms_error = 0;
};

/// The triangles of the grid, where `thinning` is given those that matter. Triangles that touch samples
/// without a height are left out. `progress`: of Thinning::moves, which may take minutes. Throws
/// std::length_error, with how many there are, above kMostTerrainTriangles; Interrupted once `progress` says
/// so.
TerrainMesh make_terrain(const HeightGrid& heights, const TerrainShape& shape,
                         const std::optional<Thinning>& thinning, const Progress& progress = {});

}  // namespace trilens
