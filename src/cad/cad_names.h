// What a STEP file calls its bodies.
#pragma once

#include <functional>
#include <string>

class TopoDS_Shape;
class XSControl_Reader;

namespace trilens {

/// The name of a solid, shell or face; empty where the file has none for it.
using NameOfShape = std::function<std::string(const TopoDS_Shape&)>;

/// Of what `reader` has transferred from a STEP file: each one's own name, as that of MANIFOLD_SOLID_BREP;
/// without one, its PRODUCT's, which exporters of parts write, unless OpenCASCADE made that up. None of an
/// IGES file.
NameOfShape find_names(const XSControl_Reader& reader);

}  // namespace trilens
