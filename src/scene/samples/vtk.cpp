// Reads the legacy VTK format by its keywords.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/util/error.h"
#include "scene/formats/line_scanner.h"
#include "scene/samples/vtk_cells.h"

namespace trilens {
namespace {

constexpr std::size_t kNoVtkType = 1'000'000;  // larger numbers of types count as this one

/// As the format names types in binary files; ids are written as int there.
std::optional<SampleType> type_of_vtk(const std::string& name) {
    const struct {
        const char* name;
        SampleType type;
    } kTypes[]{{"unsigned_char", SampleType::kUint8},
               {"char", SampleType::kInt8},
               {"signed_char", SampleType::kInt8},
               {"unsigned_short", SampleType::kUint16},
               {"short", SampleType::kInt16},
               {"unsigned_int", SampleType::kUint32},
               {"int", SampleType::kInt32},
               {"vtkIdType", SampleType::kInt32},
               {"unsigned_long", SampleType::kUint64},
               {"long", SampleType::kInt64},
               {"vtktypeuint64", SampleType::kUint64},
               {"vtktypeint64", SampleType::kInt64},
               {"float", SampleType::kFloat},
               {"double", SampleType::kDouble}};
    for (const auto& [known, type] : kTypes)
        if (name == known) return type;
    return std::nullopt;
}

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
    void read_attributes();
    void read_scalars();
    void read_field();
    void skip_cell_data();
    void skip_metadata();
    void begin(std::size_t numbers, const std::string& type, const std::string& what);
    double next();
    std::size_t next_count(const char* what);
    /// An array of a field, before its values.
    struct FieldHead {
        std::string name, type;
        std::size_t components = 1, tuples = 0;
    };
    void take_field(const FieldHead& field);
    void skip(std::size_t numbers, const std::string& type, const std::string& what);
    void read_geometry(const std::string& keyword);

    WordScanner scan_;
    const std::string& file_;
    const std::string& wanted_;
    bool is_grid_ = false;
    std::vector<Vec3> points_;
    RegularGrid grid_;
    VtkCells cells_;
    // Of binary files: the numbers that were begun.
    bool is_binary_ = false;
    std::string_view block_;
    SampleType type_ = SampleType::kFloat;
    std::vector<double> scalars_;
    std::vector<std::string> others_;  // fields that were not taken
    std::size_t point_data_ = 0;
    bool has_points_ = false, found_ = false, has_cell_data_ = false, is_skipping_ = false;
    VolumeFile result_;
};

/// Numbers follow: in binary files as that type has them, the first byte the highest.
void VtkReader::begin(std::size_t numbers, const std::string& type, const std::string& what) {
    if (!is_binary_) return scan_.expect(numbers, what);
    const std::optional<SampleType> known = type_of_vtk(type);
    if (!known) scan_.fail("numbers of the type '" + type + "' are not known here");
    type_ = *known;
    block_ = scan_.bytes(numbers * bytes_of(type_), what);
}

double VtkReader::next() {
    if (!is_binary_) return scan_.number();
    const double value = number_at(block_.data(), type_, true);
    block_.remove_prefix(bytes_of(type_));
    return value;
}

std::size_t VtkReader::next_count(const char* what) {
    if (!is_binary_) return scan_.count(what);
    const double value = next();
    if (!(value >= 0 && value <= 4e9 && value == std::floor(value)))
        scan_.fail(std::string("a whole number must stand here: ") + what);
    return static_cast<std::size_t>(value);
}

void VtkReader::read_points() {
    const std::size_t count = scan_.count("how many points");
    const std::string type(scan_.word());
    begin(3 * count, type, std::to_string(count) + " points");
    if (count >= kNone) scan_.fail("more points than can be numbered");
    points_.resize(count);
    for (std::size_t i = 0; i < count; ++i)
        for (int k = 0; k < 3; ++k) {
            points_[i][k] = next();
            if (!(std::fabs(points_[i][k]) <= 1e30))
                scan_.fail("point " + std::to_string(i) + " has a coordinate that is no number up to 1e30");
        }
    has_points_ = true;
}

/// From version 5 on: offsets, then corners.
void VtkReader::read_offsets(std::size_t offsets, std::size_t connectivity) {
    scan_.keyword("OFFSETS");
    std::string type(scan_.word());
    begin(offsets, type, std::to_string(offsets) + " offsets");
    for (std::size_t i = 0; i < offsets; ++i) {
        cells_.first_corner.push_back(next_count("an offset"));
        if (cells_.first_corner.back() > connectivity ||
            (i > 0 && cells_.first_corner[i] < cells_.first_corner[i - 1]))
            scan_.fail("offsets of cells must rise up to the number of their corners");
    }
    scan_.keyword("CONNECTIVITY");
    type = scan_.word();
    begin(connectivity, type, std::to_string(connectivity) + " corners");
    cells_.corners.resize(connectivity);
    for (Id& corner : cells_.corners) corner = static_cast<Id>(next_count("a point"));
}

void VtkReader::read_cells() {
    const std::size_t first = scan_.count("how many cells"), second = scan_.count("how many entries");
    if (first > kMostCells)
        scan_.fail(std::to_string(first) + " cells are more than the " + std::to_string(kMostCells) +
                   " that are held");
    if (in_capitals(scan_.peek()) == "OFFSETS") {
        read_offsets(first, second);
    } else {
        begin(second, "int", std::to_string(first) + " cells");
        cells_.first_corner.push_back(0);
        for (std::size_t i = 0; i < first; ++i) {
            if (is_binary_ && block_.empty()) scan_.fail("the cells have more corners than they say");
            const std::size_t corners = next_count("how many corners");
            if (cells_.corners.size() + corners + i + 1 > second)
                scan_.fail("cell " + std::to_string(i) + " has more corners than the " +
                           std::to_string(second) + " entries have room for");
            for (std::size_t k = 0; k < corners; ++k)
                cells_.corners.push_back(static_cast<Id>(next_count("a point")));
            cells_.first_corner.push_back(cells_.corners.size());
        }
    }
    for (const Id corner : cells_.corners)
        if (corner >= points_.size())
            scan_.fail("a cell names point " + std::to_string(corner) + ", but there are " +
                       std::to_string(points_.size()));
}

void VtkReader::read_types() {
    const std::size_t count = scan_.count("how many types");
    begin(count, "int", std::to_string(count) + " types");
    cells_.types.resize(count);
    for (int& type : cells_.types)
        type = static_cast<int>(std::min<std::size_t>(next_count("a type"), kNoVtkType));
    if (count + 1 != cells_.first_corner.size())
        scan_.fail("has " + std::to_string(count) + " types of cells for " +
                   std::to_string(cells_.first_corner.empty() ? 0 : cells_.first_corner.size() - 1) +
                   " cells");
}

void VtkReader::take_field(const FieldHead& field) {
    const auto& [name, type, components, tuples] = field;
    const bool fits = components == 1 && tuples == point_data_;
    if (is_skipping_) return skip(components * tuples, type, "the values of '" + name + "'");
    if (found_ || !fits || (!wanted_.empty() && name != wanted_)) {
        if (!wanted_.empty() && name == wanted_ && !fits)
            scan_.fail("the field '" + name + "' has " + std::to_string(components) + " components for " +
                       std::to_string(tuples) + " points; a scalar has one for each of " +
                       std::to_string(point_data_));
        others_.push_back(name);
        return skip(components * tuples, type, "the values of '" + name + "'");
    }
    begin(tuples, type, std::to_string(tuples) + " values of '" + name + "'");
    scalars_.resize(tuples);
    for (std::size_t i = 0; i < tuples; ++i) {
        scalars_[i] = next();
        if (!std::isfinite(scalars_[i]))
            scan_.fail("the field '" + name + "' is not finite at point " + std::to_string(i));
    }
    found_ = true;
    result_.field = name;
}

void VtkReader::skip(std::size_t numbers, const std::string& type, const std::string& what) {
    begin(numbers, type, what);
    if (is_binary_) return;
    for (std::size_t i = 0; i < numbers; ++i)
        if (scan_.word().empty()) scan_.fail("the file ends within " + what);
}

void VtkReader::read_scalars() {
    FieldHead field;
    field.name = scan_.word();
    field.type = scan_.word();
    if (parse_integer(scan_.peek())) field.components = scan_.count("how many components");
    if (in_capitals(scan_.peek()) == "LOOKUP_TABLE") {
        scan_.word();
        scan_.word();
    }
    field.tuples = point_data_;
    take_field(field);
}

void VtkReader::read_field() {
    scan_.word();  // its name
    const std::size_t arrays = scan_.count("how many arrays");
    for (std::size_t a = 0; a < arrays; ++a) {
        while (in_capitals(scan_.peek()) == "METADATA") skip_metadata();
        FieldHead field;
        field.name = scan_.word();
        if (field.name.empty()) scan_.fail("the file ends within a field");
        field.components = scan_.count("how many components");
        field.tuples = scan_.count("how many tuples");
        field.type = scan_.word();
        if (field.components > 1000) scan_.fail("an array has more than 1000 components");
        take_field(field);
    }
}

void VtkReader::read_point_data() {
    point_data_ = scan_.count("how many points");
    const std::size_t points = is_grid_ ? grid_.size[0] * grid_.size[1] * grid_.size[2] : points_.size();
    if (point_data_ != points)
        scan_.fail("has data of " + std::to_string(point_data_) + " points, but " + std::to_string(points) +
                   " points");
    read_attributes();
}

void VtkReader::read_attributes() {
    while (true) {
        const std::string key = in_capitals(scan_.peek());
        if (key.empty() || key == "CELL_DATA" || key == "POINT_DATA") return;
        scan_.word();
        if (key == "SCALARS") {
            read_scalars();
        } else if (key == "FIELD") {
            read_field();
        } else if (key == "VECTORS" || key == "NORMALS" || key == "TENSORS") {
            FieldHead field;
            field.name = scan_.word();
            field.type = scan_.word();
            field.components = key == "TENSORS" ? 9 : 3;
            field.tuples = point_data_;
            take_field(field);
        } else if (key == "LOOKUP_TABLE") {
            scan_.word();
            skip(4 * scan_.count("how many colours"), "unsigned_char", "a table of colours");
        } else if (key == "METADATA") {
            skip_metadata();
        } else {
            scan_.fail("data of the kind '" + key + "' are not known here");
        }
    }
}

/// It changes nothing. As text it ends where points' data begin, in a binary file where its values do.
void VtkReader::skip_cell_data() {
    has_cell_data_ = true;
    if (is_binary_) {
        const std::size_t before = std::exchange(point_data_, scan_.count("how many cells"));
        is_skipping_ = true;
        read_attributes();
        is_skipping_ = false;
        point_data_ = before;
        return;
    }
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

VolumeFile VtkReader::read() {
    const std::string magic(scan_.rest_of_line());
    if (!magic.starts_with("# vtk DataFile Version"))
        throw InputError(file_, "line 1", "is no legacy VTK file: those begin with '# vtk DataFile Version'");
    scan_.rest_of_line();  // the title
    const std::string encoding = in_capitals(scan_.word());
    if (encoding != "ASCII" && encoding != "BINARY")
        scan_.fail("is a VTK file in '" + encoding + "', which is neither ASCII nor BINARY");
    is_binary_ = encoding == "BINARY";
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
    if (!found_) fail_for_field(file_, wanted_, others_, has_cell_data_);
    if (is_grid_) {
        grid_.scalars = std::move(scalars_);
        result_.cells = std::move(grid_);
    } else {
        if (cells_.types.size() + 1 != cells_.first_corner.size())
            throw InputError(file_, "", "has cells without CELL_TYPES");
        CellSoup soup = soup_of_vtk(cells_, std::move(points_), file_, result_.warnings);
        soup.scalars = std::move(scalars_);
        result_.cells = std::move(soup);
    }
    return std::move(result_);
}

}  // namespace

VolumeFile parse_vtk(const std::string& bytes, const std::string& file, const std::string& field) {
    return VtkReader(bytes, file, field).read();
}

}  // namespace trilens
