// Faces of OpenCASCADE as NURBS surfaces.
#pragma once

#include "cad/cad_file.h"

class TopoDS_Face;

namespace trilens {

/// The surfaces of a face and how much of them it covers. Exact but for offset surfaces, which OpenCASCADE
/// approximates. Throws InputError(file) where it makes none.
void set_surfaces(const TopoDS_Face& face, const std::string& file, CadFace& into);

}  // namespace trilens
