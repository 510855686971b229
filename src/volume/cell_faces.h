// Cells ready for rays: gradients of the scalar, the faces between cells, and where a line passes through a
// cell.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "base/math/box.h"
#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/triangle_scene.h"
#include "volume/volume_data.h"
#include "volume/volume_integral.h"

namespace trilens {

/// The corners of a cell's face k, the one across from its corner k, counterclockwise from outside.
std::array<Id, 3> face_corners(const Tetrahedron& cell, std::size_t k);

/// Each face of a mesh once, as a scene for the projector (its triangle's number is the face's), and the
/// cells on its sides; of a face that more than two cells have, one for each two of them.
struct CellFaces {
    TriangleScene triangles;
    std::vector<std::array<Id, 2>> cells;  // behind the face's normal, and before it; kNone: outside
};

/// Faces in the order of the lowest cell that has them. Counts those that more than two cells have.
CellFaces find_faces(const TetMesh& mesh, std::size_t& crowded);

/// The gradient of the scalar in a cell, by which it is s(a) + gradient . (p - a), a a corner.
Vec3 scalar_gradient(const TetMesh& mesh, Id cell);

/// The box of a cell.
Box cell_box(const TetMesh& mesh, Id cell);

/// Where a line is in a cell, in units of its direction; t_in < t_out.
struct CellStretch {
    Id cell = kNone;
    double t_in = 0, t_out = 0;
};

/// The line of the ray clipped against the cell's four planes: none where it is in the cell nowhere.
/// Source: Cyrus and Beck, Generalized Two- and Three-Dimensional Clipping, Computers and Graphics 3, 1978.
std::optional<CellStretch> clip_line(const TetMesh& mesh, Id cell, const Ray& ray);

/// A face that a ray crosses.
struct FaceCrossing {
    Id face = kNone;
    double t = 0;
};

/// The cells that a ray passes between t = 0 and t = until, in order of where it comes in, from the faces
/// that it crosses: it comes into a cell where it crosses a face toward it, and leaves where it crosses
/// another, or, where that lies beyond what is asked for, by the nearest plane behind; a cell that it leaves
/// without having come in holds its start. `crossings`: all between 0 and `until`, in any order, and where
/// there are none, the first one behind, if any. Source: Weiler, Kraus, Ertl, Hardware-Based View-Independent
/// Cell Projection, IEEE Symposium on Volume Visualization and Graphics, 2002, with the far face projected,
/// too: a ray that runs along a face is then in no doubt about where it leaves.
class CrossedCells {
  public:
    CrossedCells(const TetMesh& mesh, const CellFaces& faces) : mesh_(mesh), faces_(faces) {}
    std::vector<CellStretch> find(const Ray& ray, double until,
                                  std::span<const FaceCrossing> crossings) const;

  private:
    const TetMesh& mesh_;
    const CellFaces& faces_;
};

/// Sorts the cells that a ray passes by where it comes in, and cuts them to [0, until]. Where cells overlap,
/// as they do for a ray that runs along their common face, the one that it came into first counts, of several
/// the lowest; cells without a length, to 1e-9 of t, go, and gaps of no length are closed.
void order_cells(double until, std::vector<CellStretch>& cells);

/// The scalar along a ray in the cells that it passes; `gradients`: of all cells of the mesh.
std::vector<ScalarStretch> scalars_along(const TetMesh& mesh, std::span<const Vec3> gradients, const Ray& ray,
                                         std::span<const CellStretch> cells);

}  // namespace trilens
