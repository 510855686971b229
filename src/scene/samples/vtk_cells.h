// What VTK's legacy and XML formats share: numbered kinds of cells, and which field is taken.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "scene/samples/volume_file.h"

namespace trilens {

/// Cells as VTK holds them.
struct VtkCells {
    std::vector<std::size_t> first_corner;  // of each cell, and one more
    std::vector<Id> corners;                // indices of points
    std::vector<int> types;                 // by VTK's numbers
};

/// The cells of volume among all cells, the others with a warning. Throws InputError(file, "") where a cell
/// has not as many corners as its type, and where none is left.
CellSoup soup_of_vtk(const VtkCells& cells, std::vector<Vec3> points, const std::string& file,
                     std::vector<std::string>& warnings);

/// Throws InputError(file, "") where the field that was wanted (empty: any) was not there; `others`: those
/// that were.
[[noreturn]] void fail_for_field(const std::string& file, const std::string& wanted,
                                 const std::vector<std::string>& others, bool has_cell_data);

}  // namespace trilens
