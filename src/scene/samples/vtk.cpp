// Reads the legacy VTK format by its keywords.
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/util/error.h"
#include "scene/formats/line_scanner.h"
#include "scene/samples/volume_file.h"

namespace trilens {
namespace {

// Numbers of VTK's cells (vtkCellType.h).
constexpr int kVtkTetra = 10, kVtkVoxel = 11, kVtkHexahedron = 12, kVtkWedge = 13, kVtkPyramid = 14;

class VtkReader {
  public:
    VtkReader(const std::string& bytes, const std::string& file, const std::string& field)
        : scan_(bytes, file), file_(file), wanted_(field) {}
    VolumeFile read();

  private:
    void read_points();
    void read_cells();
    void read_offsets(std::size_t offsets, std::size_t connectivity);
    void read_types();
    void read_point_data();
    void read_scalars();
    void read_field();
    void skip_cell_data();
    void skip_metadata();
    void take_field(const std::string& name, std::size_t components, std::size_t tuples);
    void skip(std::size_t numbers, const std::string& what);
    void read_geometry(const std::string& keyword);
    void make_soup();

    WordScanner scan_;
    const std::string& file_;
    const std::string& wanted_;
    bool is_grid_ = false;
    CellSoup soup_;
    RegularGrid grid_;
    std::vector<std::size_t> first_corner_;  // of each cell, and one more
    std::vector<Id> corners_;
    std::vector<int> types_;
    std::vector<double> scalars_;
    std::vector<std::string> others_;  // fields that were not taken
    std::size_t point_data_ = 0;
    bool has_points_ = false, found_ = false, has_cell_data_ = false;
    VolumeFile result_;
};

void VtkReader::read_points() {
    const std::size_t count = scan_.count("how many points");
    scan_.word();  // their type
    scan_.expect(3 * count, std::to_string(count) + " points");
    if (count >= kNone) scan_.fail("more points than can be numbered");
    soup_.points.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) {
            soup_.points[i][k] = scan_.number();
            if (!(std::fabs(soup_.points[i][k]) <= 1e30))
                scan_.fail("point " + std::to_string(i) + " has a coordinate that is no number up to 1e30");
        }
    has_points_ = true;
}

/// From version 5 on: offsets, then corners.
void VtkReader::read_offsets(std::size_t offsets, std::size_t connectivity) {
    scan_.keyword("OFFSETS");
    scan_.word();
    scan_.expect(offsets, std::to_string(offsets) + " offsets");
    for (std::size_t i = 0; i < offsets; ++i) {
        first_corner_.push_back(scan_.count("an offset"));
        if (first_corner_.back() > connectivity || (i > 0 && first_corner_[i] < first_corner_[i - 1]))
            scan_.fail("offsets of cells must rise up to the number of their corners");
    }
    scan_.keyword("CONNECTIVITY");
    scan_.word();
    scan_.expect(connectivity, std::to_string(connectivity) + " corners");
    corners_.resize(connectivity);
    for (Id& corner : corners_) corner = static_cast<Id>(scan_.count("a point"));
}

void VtkReader::read_cells() {
    const std::size_t first = scan_.count("how many cells"), second = scan_.count("how many entries");
    if (first > kMostCells)
        scan_.fail(std::to_string(first) + " cells are more than the " + std::to_string(kMostCells) +
                   " that are held");
    if (in_capitals(scan_.peek()) == "OFFSETS") {
        read_offsets(first, second);
    } else {
        scan_.expect(second, std::to_string(first) + " cells");
        first_corner_.push_back(0);
        for (std::size_t i = 0; i < first; ++i) {
            const std::size_t corners = scan_.count("how many corners");
            if (corners_.size() + corners + i + 1 > second)
                scan_.fail("cell " + std::to_string(i) + " has more corners than the " +
                           std::to_string(second) + " entries have room for");
            for (std::size_t k = 0; k < corners; ++k)
                corners_.push_back(static_cast<Id>(scan_.count("a point")));
            first_corner_.push_back(corners_.size());
        }
    }
    for (const Id corner : corners_)
        if (corner >= soup_.points.size())
            scan_.fail("a cell names point " + std::to_string(corner) + ", but there are " +
                       std::to_string(soup_.points.size()));
}

void VtkReader::read_types() {
    const std::size_t count = scan_.count("how many types");
    scan_.expect(count, std::to_string(count) + " types");
    types_.resize(count);
    for (int& type : types_) type = static_cast<int>(scan_.count("a type"));
    if (count + 1 != first_corner_.size())
        scan_.fail("has " + std::to_string(count) + " types of cells for " +
                   std::to_string(first_corner_.empty() ? 0 : first_corner_.size() - 1) + " cells");
}

void VtkReader::take_field(const std::string& name, std::size_t components, std::size_t tuples) {
    const bool fits = components == 1 && tuples == point_data_;
    if (found_ || !fits || (!wanted_.empty() && name != wanted_)) {
        if (!wanted_.empty() && name == wanted_ && !fits)
            scan_.fail("the field '" + name + "' has " + std::to_string(components) + " components for " +
                       std::to_string(tuples) + " points; a scalar has one for each of " +
                       std::to_string(point_data_));
        others_.push_back(name);
        return skip(components * tuples, "the values of '" + name + "'");
    }
    scan_.expect(tuples, std::to_string(tuples) + " values of '" + name + "'");
    scalars_.resize(tuples);
    for (std::size_t i = 0; i < tuples; ++i) {
        scalars_[i] = scan_.number();
        if (!std::isfinite(scalars_[i]))
            scan_.fail("the field '" + name + "' is not finite at point " + std::to_string(i));
    }
    found_ = true;
    result_.field = name;
}

void VtkReader::skip(std::size_t numbers, const std::string& what) {
    scan_.expect(numbers, what);
    for (std::size_t i = 0; i < numbers; ++i)
        if (scan_.word().empty()) scan_.fail("the file ends within " + what);
}

void VtkReader::read_scalars() {
    const std::string name(scan_.word());
    scan_.word();  // type
    std::size_t components = 1;
    if (parse_integer(scan_.peek())) components = scan_.count("how many components");
    if (in_capitals(scan_.peek()) == "LOOKUP_TABLE") {
        scan_.word();
        scan_.word();
    }
    take_field(name, components, point_data_);
}

void VtkReader::read_field() {
    scan_.word();  // its name
    const std::size_t arrays = scan_.count("how many arrays");
    for (std::size_t a = 0; a < arrays; ++a) {
        while (in_capitals(scan_.peek()) == "METADATA") skip_metadata();
        const std::string name(scan_.word());
        if (name.empty()) scan_.fail("the file ends within a field");
        const std::size_t components = scan_.count("how many components"),
                          tuples = scan_.count("how many tuples");
        scan_.word();
        if (components > 1000) scan_.fail("an array has more than 1000 components");
        take_field(name, components, tuples);
    }
}

void VtkReader::read_point_data() {
    point_data_ = scan_.count("how many points");
    const std::size_t points = is_grid_ ? grid_.size[0] * grid_.size[1] * grid_.size[2] : soup_.points.size();
    if (point_data_ != points)
        scan_.fail("has data of " + std::to_string(point_data_) + " points, but " + std::to_string(points) +
                   " points");
    while (true) {
        const std::string key = in_capitals(scan_.peek());
        if (key.empty() || key == "CELL_DATA") return;
        scan_.word();
        if (key == "SCALARS") {
            read_scalars();
        } else if (key == "FIELD") {
            read_field();
        } else if (key == "VECTORS" || key == "NORMALS" || key == "TENSORS") {
            const std::string name(scan_.word());
            scan_.word();
            take_field(name, key == "TENSORS" ? 9 : 3, point_data_);
        } else if (key == "LOOKUP_TABLE") {
            scan_.word();
            skip(4 * scan_.count("how many colours"), "a table of colours");
        } else if (key == "METADATA") {
            skip_metadata();
        } else {
            scan_.fail("data of the kind '" + key + "' are not known here");
        }
    }
}

/// What stands after the points' data changes nothing; before them, its length must be known.
void VtkReader::skip_cell_data() {
    has_cell_data_ = true;
    while (!scan_.peek().empty() && in_capitals(scan_.peek()) != "POINT_DATA") scan_.word();
}

/// It ends with an empty line.
void VtkReader::skip_metadata() {
    scan_.rest_of_line();
    while (!scan_.rest_of_line().empty()) {
    }
}

void VtkReader::read_geometry(const std::string& keyword) {
    if (!is_grid_ && keyword == "POINTS") return read_points();
    if (!is_grid_ && keyword == "CELLS") {
        if (!has_points_) scan_.fail("CELLS must come after POINTS");
        return read_cells();
    }
    if (!is_grid_ && keyword == "CELL_TYPES") return read_types();
    if (is_grid_ && keyword == "DIMENSIONS") {
        for (std::size_t& side : grid_.size) side = scan_.count("how many points along an axis");
        checked_point_count(grid_.size, file_, "line " + std::to_string(scan_.line()));
        return;
    }
    if (is_grid_ && keyword == "ORIGIN") {
        for (int k = 0; k < 3; ++k) grid_.origin[k] = scan_.number();
        return;
    }
    if (is_grid_ && (keyword == "SPACING" || keyword == "ASPECT_RATIO")) {
        for (int k = 0; k < 3; ++k) {
            grid_.steps[k][k] = scan_.number();
            if (!(grid_.steps[k][k] > 0)) scan_.fail("a spacing must be positive");
        }
        return;
    }
    scan_.fail("the keyword '" + keyword + "' is not known here");
}

/// Cells of volume out of all cells.
void VtkReader::make_soup() {
    std::size_t others = 0;
    for (std::size_t c = 0; c + 1 < first_corner_.size(); ++c) {
        const std::size_t first = first_corner_[c], count = first_corner_[c + 1] - first;
        CellShape shape = CellShape::kTetrahedron;
        switch (types_[c]) {
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
            throw InputError(file_, "",
                             "cell " + std::to_string(c) + " has " + std::to_string(count) +
                                 " corners, but its type has " + std::to_string(corner_count(shape)));
        soup_.shapes.push_back(shape);
        for (std::size_t k = 0; k < count; ++k) soup_.corners.push_back(corners_[first + k]);
        if (types_[c] == kVtkVoxel) {  // its corners in rows
            Id* const own = soup_.corners.data() + soup_.corners.size() - 8;
            std::swap(own[2], own[3]);
            std::swap(own[6], own[7]);
        }
    }
    if (others > 0)
        result_.warnings.push_back(std::to_string(others) +
                                   " cells are no tetrahedra, pyramids, wedges, hexahedra or voxels: they "
                                   "are left out");
    if (soup_.shapes.empty()) throw InputError(file_, "", "has no cells with a volume");
}

VolumeFile VtkReader::read() {
    const std::string magic(scan_.rest_of_line());
    if (!magic.starts_with("# vtk DataFile Version"))
        throw InputError(file_, "line 1", "is no legacy VTK file: those begin with '# vtk DataFile Version'");
    scan_.rest_of_line();  // the title
    const std::string encoding = in_capitals(scan_.word());
    if (encoding != "ASCII")
        scan_.fail("is a VTK file in " + encoding + "; ASCII is read: write it again as that");
    scan_.keyword("DATASET");
    const std::string kind = in_capitals(scan_.word());
    if (kind != "UNSTRUCTURED_GRID" && kind != "STRUCTURED_POINTS")
        scan_.fail("holds " + kind + "; UNSTRUCTURED_GRID and STRUCTURED_POINTS are read");
    is_grid_ = kind == "STRUCTURED_POINTS";
    while (true) {
        const std::string key = in_capitals(scan_.word());
        if (key.empty()) break;
        if (key == "POINT_DATA") {
            if (is_grid_ && grid_.size[0] == 0) scan_.fail("POINT_DATA must come after DIMENSIONS");
            read_point_data();
        } else if (key == "CELL_DATA") {
            skip_cell_data();
        } else if (key == "METADATA") {
            skip_metadata();
        } else if (key == "FIELD") {  // of the whole data set: time and the like
            const std::size_t before = std::exchange(point_data_, ~std::size_t{0});
            read_field();
            point_data_ = before;
            others_.clear();
        } else {
            read_geometry(key);
        }
    }
    if (!found_) {
        std::string names;
        for (const std::string& name : others_) names += (names.empty() ? "'" : ", '") + name + "'";
        throw InputError(
            file_, "",
            (wanted_.empty() ? std::string("has no field of one component at its points")
                             : "has no field '" + wanted_ + "' at its points") +
                (names.empty() ? "" : "; it has " + names) +
                (has_cell_data_ ? "; data of cells are not read: have them averaged at points" : ""));
    }
    if (is_grid_) {
        grid_.scalars = std::move(scalars_);
        result_.cells = std::move(grid_);
    } else {
        if (types_.size() + 1 != first_corner_.size())
            throw InputError(file_, "", "has cells without CELL_TYPES");
        make_soup();
        soup_.scalars = std::move(scalars_);
        result_.cells = std::move(soup_);
    }
    return std::move(result_);
}

}  // namespace

VolumeFile parse_vtk(const std::string& bytes, const std::string& file, const std::string& field) {
    return VtkReader(bytes, file, field).read();
}

}  // namespace trilens
