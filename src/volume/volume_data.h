// A volume as plain data: tetrahedra with a scalar at each vertex, and which colour and extinction a scalar
// has.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

/// Corners of a tetrahedron: indices into TetMesh::points.
using Tetrahedron = std::array<Id, 4>;

/// What was found while a mesh was made.
struct CellCounts {
    std::size_t cells = 0;     // as the file has them
    std::size_t inverted = 0;  // tetrahedra of the file whose corners were swapped
    std::size_t flat = 0;      // tetrahedra without a volume, left out
    std::size_t folded = 0;    // other cells, some of whose tetrahedra are inverted: they overlap others
    std::size_t crowded = 0;   // faces that more than two cells have
    std::size_t open = 0;      // faces of one cell where another cell touches without having that face
};

/// Tetrahedra of positive volume, dot(cross(b - a, c - a), d - a) > 0, all in one frame.
struct TetMesh {
    std::vector<Vec3> points;
    std::vector<double> scalars;     // one per point, finite
    std::vector<Tetrahedron> cells;  // ids of cells count here
    CellCounts counts;

    bool operator==(const TetMesh& other) const {
        return points == other.points && scalars == other.scalars && cells == other.cells;
    }
};

/// What a volume is like where its scalar has this value.
struct TransferPoint {
    double value = 0;
    Vec3 color{1};          // radiance that an opaque volume of it has, linear Rec.709
    double extinction = 0;  // per world unit: how much of the light is lost over a short way, divided by it

    bool operator==(const TransferPoint&) const = default;
};

/// Linear between its points, constant beyond the first and the last.
struct TransferFunction {
    std::vector<TransferPoint> points;  // at least one; their values rise

    bool operator==(const TransferFunction&) const = default;

    /// The colour and extinction at this value.
    TransferPoint at(double value) const;
};

}  // namespace trilens
