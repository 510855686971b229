// Faces of OpenCASCADE as NURBS surfaces.
#pragma once

#include "cad/cad_file.h"

class TopoDS_Face;

namespace trilens {

/// The surfaces of a face and how much of them it covers, or its fault. Exact but for offset surfaces, which
/// OpenCASCADE approximates.
void set_surfaces(const TopoDS_Face& face, CadFace& into);

}  // namespace trilens
