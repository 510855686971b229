// Unstructured grids as tetrahedra with a scalar at each vertex: cells split by their lowest vertices,
// turned, and counted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "volume/volume_data.h"

namespace trilens {

/// Cells as files have them; corners in the order of VTK's cells of the same names.
enum class CellShape : std::uint8_t { kTetrahedron, kPyramid, kWedge, kHexahedron };

/// Corners that a cell of this shape has.
std::size_t corner_count(CellShape shape);

/// More cells than this are refused.
inline constexpr std::size_t kMostCells = 50'000'000;

/// Cells as read: corner_count(shape) corners of each, one cell after the other.
struct CellSoup {
    std::vector<Vec3> points;
    std::vector<double> scalars;  // one per point
    std::vector<CellShape> shapes;
    std::vector<Id> corners;  // indices into points
};

/// Appends the tetrahedra of one cell: the pulling triangulation of its lowest corner, each face split from
/// the face's own lowest corner, so that two cells which share a face split it alike. Source: Dompierre,
/// Labbe, Vallet, Camarero, How to Subdivide Pyramids, Prisms, and Hexahedra into Tetrahedra, 8th
/// International Meshing Roundtable, 1999. corners.size() == corner_count(shape).
void split_cell(CellShape shape, std::span<const Id> corners, std::vector<Tetrahedron>& tetrahedra);

/// Splits, turns and counts. The soup's corners are points, its scalars finite, its points within coordinates
/// whose products of three fit in a double. A tetrahedron is flat whose volume is no more than 1e-14 times
/// the cube of its longest edge. `crowded` and `open` are counted by find_faces and
/// count_open_faces.
TetMesh make_tet_mesh(CellSoup soup);

/// A regular grid of size[0] x size[1] x size[2] points, x fastest, at origin + steps * index, each of its
/// boxes split as a hexahedron. scalars.size() is the product of the sizes, each of which is at least 2.
struct RegularGrid {
    std::array<std::size_t, 3> size{};
    Vec3 origin{0};
    Mat3 steps{1};  // columns: from one point to the next along each axis
    std::vector<double> scalars;
};
TetMesh make_tet_mesh(RegularGrid grid);

}  // namespace trilens
