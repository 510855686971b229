// Where cells of a mesh touch without sharing a face: hanging vertices, faces split otherwise, seams,
// overlaps.
#pragma once

#include <cstddef>

#include "volume/cell_faces.h"

namespace trilens {

/// Faces that one cell alone has and whose middle another cell holds, to 1e-9 of that cell's size: there the
/// mesh does not conform.
std::size_t count_open_faces(const TetMesh& mesh, const CellFaces& faces);

}  // namespace trilens
