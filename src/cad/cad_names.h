// What a STEP file calls its bodies.
#pragma once

#include <NCollection_DataMap.hxx>
#include <TopTools_ShapeMapHasher.hxx>
#include <TopoDS_Shape.hxx>
#include <XSControl_Reader.hxx>
#include <string>

namespace trilens {

/// By a shape without its place.
using ShapeNames = NCollection_DataMap<TopoDS_Shape, std::string, TopTools_ShapeMapHasher>;

/// Names of the solids, shells and faces that `reader` has transferred from a STEP file: each one's own name,
/// as that of MANIFOLD_SOLID_BREP; without one, its PRODUCT's, which exporters of parts write, unless
/// OpenCASCADE made that up. None of an IGES file.
ShapeNames find_names(const XSControl_Reader& reader);

}  // namespace trilens
