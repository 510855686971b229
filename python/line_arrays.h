// Caustics and fold curves of line drawings as numpy arrays.
#pragma once

#include "arrays.h"

namespace trilens::python {

/// A dict for each sheet: path, optic, sheet, virtual, points, triangles, segments.
py::list caustic_list(const LineDrawing& drawing);

/// A dict for each curve: object, points, places.
py::list fold_list(const LineDrawing& drawing);

}  // namespace trilens::python
