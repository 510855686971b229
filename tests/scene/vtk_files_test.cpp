// VTK's binary and XML files: one tetrahedron in every way to write it, and files that lie.
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/util/error.h"
#include "scene/samples/volume_file.h"
#include "scene/scene_text.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// As if nothing were packed.
bool unpacked(std::string_view packed, std::span<char> to) {
    if (packed.size() != to.size()) return false;
    std::copy(packed.begin(), packed.end(), to.begin());
    return true;
}

template <typename T>
std::string bytes(const std::vector<T>& values, bool big) {
    std::string all;
    for (const T& value : values) {
        std::string one(reinterpret_cast<const char*>(&value), sizeof(T));
        if (big) std::reverse(one.begin(), one.end());
        all += one;
    }
    return all;
}

std::string base64(const std::string& raw) {
    constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < raw.size(); i += 3) {
        std::uint32_t bits = 0;
        for (std::size_t k = 0; k < 3; ++k)
            bits = bits << 8 | (i + k < raw.size() ? static_cast<unsigned char>(raw[i + k]) : 0);
        for (std::size_t k = 0; k < 4; ++k)
            text += i + k > raw.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
    }
    return text;
}

/// How a file is written.
struct Way {
    bool big = false, long_words = false, packed = false;
    const char* format = "binary";  // or "appended", "raw"
};

const std::vector<float> kTetPlaces{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
const std::vector<double> kTetHeat{0, 1, 2, 2.5};

class VtuWriter {
  public:
    explicit VtuWriter(const Way& way) : way_(way) {}

    std::string file() {
        const std::string arrays =
            "<Points>" + array("", "Float32", bytes(kTetPlaces, way_.big), 3) + "</Points><Cells>" +
            array("connectivity", "Int64", bytes(std::vector<std::int64_t>{0, 1, 2, 3}, way_.big)) +
            array("offsets", "Int32", bytes(std::vector<std::int32_t>{4}, way_.big)) +
            array("types", "UInt8", bytes(std::vector<std::uint8_t>{10}, way_.big)) + "</Cells><PointData>" +
            array("heat", "Float64", bytes(kTetHeat, way_.big)) + "</PointData>";
        const std::string head =
            std::string(
                "<?xml version=\"1.0\"?>\n<!-- > -->\n<VTKFile type='UnstructuredGrid' byte_order=\"") +
            (way_.big ? "BigEndian" : "LittleEndian") + "\" header_type=\"" +
            (way_.long_words ? "UInt64" : "UInt32") + "\"" +
            (way_.packed ? " compressor=\"vtkZLibDataCompressor\"" : "") +
            "><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\">" + arrays +
            "</Piece></UnstructuredGrid>";
        const bool is_raw = std::string(way_.format) == "raw";
        const std::string tail = appended_.empty() ? ""
                                                   : std::string("<AppendedData encoding=\"") +
                                                         (is_raw ? "raw" : "base64") + "\">\n _" + appended_ +
                                                         "\n</AppendedData>";
        return head + tail + "</VTKFile>\n";
    }

  private:
    std::string words(const std::vector<std::uint64_t>& values) const {
        if (way_.long_words) return bytes(values, way_.big);
        return bytes(std::vector<std::uint32_t>(values.begin(), values.end()), way_.big);
    }
    /// Packed: in blocks of 5 bytes, the last one with what is left.
    std::string array(const std::string& name, const std::string& type, const std::string& content,
                      int components = 1) {
        std::vector<std::uint64_t> sizes;
        for (std::size_t i = 0; i < content.size(); i += 5)
            sizes.push_back(std::min<std::uint64_t>(5, content.size() - i));
        std::vector<std::uint64_t> head{sizes.size(), 5, content.size() % 5};
        head.insert(head.end(), sizes.begin(), sizes.end());
        const bool is_raw = std::string(way_.format) == "raw";
        const auto text = [&](const std::string& raw) { return is_raw ? raw : base64(raw); };
        const std::string stored =
            way_.packed ? text(words(head)) + text(content) : text(words({content.size()}) + content);
        std::string tag = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
                          std::to_string(components) + "\" format=\"";
        if (std::string(way_.format) == "binary")
            return tag + "binary\">\n  " + stored + "\n<InformationKey name=\"x\"/></DataArray>";
        tag += "appended\" offset=\"" + std::to_string(appended_.size()) + "\"/>";
        appended_ += stored;
        return tag;
    }

    Way way_;
    std::string appended_;
};

VolumeFile read(const std::string& text, const std::string& field = "") {
    return parse_vtu(text, "a.vtu", field, unpacked);
}

std::string refusal_of(const std::string& text, const std::string& field = "") {
    try {
        read(text, field);
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

void check_tetrahedron(const VolumeFile& file) {
    const CellSoup& soup = std::get<CellSoup>(file.cells);
    REQUIRE(soup.points.size() == 4);
    CHECK(soup.points[2] == Vec3(0, 1, 0));
    CHECK(soup.corners == std::vector<Id>{0, 1, 2, 3});
    CHECK(soup.scalars == kTetHeat);
    CHECK(file.field == "heat");
    CHECK(file.warnings.empty());
}

}  // namespace

TEST_CASE("VTK's XML files are read in every encoding", "[scene]") {
    for (const char* format : {"binary", "appended", "raw"})
        for (const bool big : {false, true})
            for (const bool long_words : {false, true})
                for (const bool packed : {false, true}) {
                    INFO(format << (big ? " big" : "") << (long_words ? " long" : "")
                                << (packed ? " packed" : ""));
                    check_tetrahedron(read(VtuWriter({big, long_words, packed, format}).file()));
                }
}

TEST_CASE("VTK's XML files of text and several pieces are read, cells without a volume left out", "[scene]") {
    const std::string piece =
        "<Piece NumberOfPoints=\"4\" NumberOfCells=\"2\"><PointData><DataArray Name=\"a &lt;b&gt;\" "
        "type=\"Float32\">1 2 3 4"
        "</DataArray></PointData><Points><DataArray NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 "
        "1</DataArray></Points>"
        "<Cells><DataArray Name=\"connectivity\">0 1 2 3 0 1 2</DataArray><DataArray Name=\"offsets\">4 "
        "7</DataArray>"
        "<DataArray Name=\"types\">10 5</DataArray></Cells></Piece>";
    const VolumeFile file =
        read("<VTKFile type=\"UnstructuredGrid\">" + piece + piece + "</VTKFile>", "a <b>");
    const CellSoup& soup = std::get<CellSoup>(file.cells);
    CHECK(soup.points.size() == 8);
    CHECK(soup.corners == std::vector<Id>{0, 1, 2, 3, 4, 5, 6, 7});
    CHECK(soup.scalars == std::vector<double>{1, 2, 3, 4, 1, 2, 3, 4});
    REQUIRE(file.warnings.size() == 1);
    CHECK(contains(file.warnings[0], "2 cells are no tetrahedra"));
}

TEST_CASE("VTK's XML files that lie are refused", "[scene][bad-input]") {
    const std::string good = VtuWriter({}).file(), packed = VtuWriter({false, false, true}).file(),
                      raw = VtuWriter({false, false, false, "raw"}).file();
    CHECK(refusal_of(good).empty());
    // Orders, words and sizes that are others than the file's.
    CHECK(contains(refusal_of(replaced(good, "LittleEndian", "BigEndian")),
                   "the byte order, header_type, or a number"));
    CHECK(contains(refusal_of(replaced(good, "UInt32", "UInt64")), "bytes"));
    CHECK(contains(refusal_of(replaced(packed, "LittleEndian", "BigEndian")), "packed blocks"));
    CHECK(contains(refusal_of(replaced(good, "NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000\"")),
                   "48 bytes, but should have 48000000000"));
    CHECK(contains(refusal_of(replaced(packed, "NumberOfPoints=\"4\"", "NumberOfPoints=\"4000000000\"")),
                   "but should have 48000000000 bytes"));
    CHECK(contains(refusal_of(replaced(good, "NumberOfCells=\"1\"", "NumberOfCells=\"99999999999\"")),
                   "more than"));
    CHECK(
        contains(refusal_of(replaced(good, "NumberOfCells=\"1\"", "NumberOfCells=\"-1\"")), "whole number"));
    CHECK(contains(refusal_of(replaced(good, "Float64", "Complex")), "'Complex', which is none"));
    CHECK(contains(refusal_of(replaced(packed, "ZLib", "LZ4")), "vtkLZ4DataCompressor"));
    // Base64 and raw data that end too soon.
    const std::size_t heat = good.find("heat");
    const std::size_t data = good.find('>', heat) + 20;
    CHECK(contains(refusal_of(good.substr(0, data) + good.substr(good.find('<', data))), "is cut off"));
    CHECK(contains(refusal_of(replaced(good, "<InformationKey", "!!!").substr(0, data)), "is cut off"));
    CHECK(contains(refusal_of(raw.substr(0, raw.size() - 80)), "is cut off"));
    CHECK(contains(refusal_of(replaced(raw, "offset=\"0\"", "offset=\"99999999\"")), "more than"));
    // A block that does not unpack.
    CHECK(contains(refusal_of(replaced(
                       packed, base64(bytes(std::vector<std::uint32_t>{7, 5, 2, 5, 5, 5, 5, 5, 5, 2}, false)),
                       base64(bytes(std::vector<std::uint32_t>{7, 5, 2, 4, 5, 5, 5, 5, 5, 2}, false)))),
                   "is damaged"));
    CHECK(contains(refusal_of(good, "cold"), "has no field 'cold' at its points; it has 'heat'"));
    CHECK(contains(refusal_of("<VTKFile type=\"ImageData\">"), "holds 'ImageData'"));
    CHECK(contains(refusal_of("<html>"), "<VTKFile"));
    CHECK(contains(refusal_of(""), "<VTKFile"));
    CHECK(contains(refusal_of("<VTKFile type=\"UnstructuredGrid\"><Piece NumberOfPoints="), "quotes"));
    CHECK(contains(refusal_of("<VTKFile type=\"UnstructuredGrid\">"), "has no piece"));
    // Every file that is cut off anywhere is refused, or complete but for its end.
    for (const std::string& text : {good, packed, raw})
        for (std::size_t length = 0; length < text.size(); length += 7) {
            const std::string told = refusal_of(text.substr(0, length));
            if (told.empty()) CHECK(length > text.size() - 120);
        }
}

TEST_CASE("VTK's legacy files are read in binary, with their cells' data passed over", "[scene]") {
    const std::string head = "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
    const std::string points = "POINTS 4 float\n" + bytes(kTetPlaces, true) + "\n";
    const std::string types = "CELL_TYPES 1\n" + bytes(std::vector<std::int32_t>{10}, true) + "\n";
    const std::string old_cells =
        "CELLS 1 5\n" + bytes(std::vector<std::int32_t>{4, 0, 1, 2, 3}, true) + "\n";
    const std::string new_cells =
        "CELLS 2 4\nOFFSETS vtktypeint64\n" + bytes(std::vector<std::int64_t>{0, 4}, true) +
        "\nCONNECTIVITY vtktypeint64\n" + bytes(std::vector<std::int64_t>{0, 1, 2, 3}, true) + "\n";
    // Of cells a byte that is a line's end.
    const std::string data = "CELL_DATA 1\nSCALARS part int\nLOOKUP_TABLE default\n" +
                             bytes(std::vector<std::int32_t>{10}, true) +
                             "\nPOINT_DATA 4\nVECTORS v float\n" + bytes(kTetPlaces, true) +
                             "\nFIELD FieldData 1\nheat 1 4 double\n" + bytes(kTetHeat, true) + "\n";
    for (const std::string& cells : {old_cells, new_cells})
        check_tetrahedron(parse_vtk(head + points + cells + types + data, "a.vtk", ""));
    const std::string whole = head + points + old_cells + types + data;
    const auto told = [&](const std::string& text) {
        try {
            parse_vtk(text, "a.vtk", "");
            return std::string();
        } catch (const InputError& error) {
            return std::string(error.what());
        }
    };
    CHECK(contains(told(whole.substr(0, whole.size() - 9)), "too short"));
    CHECK(contains(told(replaced(whole, "POINTS 4 float", "POINTS 4000000000 double")), "too short"));
    CHECK(contains(told(replaced(whole, "POINTS 4 float", "POINTS 4 bit")), "'bit' are not known"));
    CHECK(contains(told(replaced(whole, "BINARY", "EBCDIC")), "neither ASCII nor BINARY"));
    for (std::size_t length = 0; length + 1 < whole.size(); ++length)
        CHECK(!told(whole.substr(0, length)).empty());
}
