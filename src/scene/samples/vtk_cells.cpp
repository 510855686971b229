#include "scene/samples/vtk_cells.h"

#include <utility>

#include "base/util/error.h"

namespace trilens {
namespace {

// Numbers of VTK's cells (vtkCellType.h).
constexpr int kVtkTetra = 10, kVtkVoxel = 11, kVtkHexahedron = 12, kVtkWedge = 13, kVtkPyramid = 14;

}  // namespace

CellSoup soup_of_vtk(const VtkCells& cells, std::vector<Vec3> points, const std::string& file,
                     std::vector<std::string>& warnings) {
    CellSoup soup;
    soup.points = std::move(points);
    std::size_t others = 0;
    for (std::size_t c = 0; c + 1 < cells.first_corner.size(); ++c) {
        const std::size_t first = cells.first_corner[c], count = cells.first_corner[c + 1] - first;
        CellShape shape = CellShape::kTetrahedron;
        switch (cells.types[c]) {
            case kVtkTetra:
                break;
            case kVtkVoxel:
            case kVtkHexahedron:
                shape = CellShape::kHexahedron;
                break;
            case kVtkWedge:
                shape = CellShape::kWedge;
                break;
            case kVtkPyramid:
                shape = CellShape::kPyramid;
                break;
            default:
                ++others;
                continue;
        }
        if (count != corner_count(shape))
            throw InputError(file, "",
                             "cell " + std::to_string(c) + " has " + std::to_string(count) +
                                 " corners, but its type has " + std::to_string(corner_count(shape)));
        soup.shapes.push_back(shape);
        for (std::size_t k = 0; k < count; ++k) soup.corners.push_back(cells.corners[first + k]);
        if (cells.types[c] == kVtkVoxel) {  // its corners in rows
            Id* const own = soup.corners.data() + soup.corners.size() - 8;
            std::swap(own[2], own[3]);
            std::swap(own[6], own[7]);
        }
    }
    if (others > 0)
        warnings.push_back(std::to_string(others) +
                           " cells are no tetrahedra, pyramids, wedges, hexahedra or voxels: they "
                           "are left out");
    if (soup.shapes.empty()) throw InputError(file, "", "has no cells with a volume");
    return soup;
}

void fail_for_field(const std::string& file, const std::string& wanted,
                    const std::vector<std::string>& others, bool has_cell_data) {
    std::string names;
    for (const std::string& name : others) names += (names.empty() ? "'" : ", '") + name + "'";
    throw InputError(file, "",
                     (wanted.empty() ? std::string("has no field of one component at its points")
                                     : "has no field '" + wanted + "' at its points") +
                         (names.empty() ? "" : "; it has " + names) +
                         (has_cell_data ? "; data of cells are not read: have them averaged at points" : ""));
}

}  // namespace trilens
