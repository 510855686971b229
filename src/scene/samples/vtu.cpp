// Reads unstructured grids in VTK's XML format: tags one after the other, arrays once their sizes are known.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string_view>

#include "base/util/error.h"
#include "scene/formats/line_scanner.h"
#include "scene/samples/vtk_cells.h"
#include "scene/samples/xml_tags.h"

namespace trilens {
namespace {

/// No stream of zlib grows by more.
constexpr std::size_t kMostGrowth = 1100;

/// The first bytes of base64 (RFC 4648): spaces are passed over, and what is padded in the middle, as where
/// two streams follow each other, goes on. Fewer where the text ends or is something else.
std::string decode_base64(std::string_view text, std::size_t wanted) {
    std::string bytes;
    std::uint32_t bits = 0;
    int held = 0;
    for (const char c : text) {
        if (bytes.size() >= wanted) break;
        const int digit = c >= 'A' && c <= 'Z'   ? c - 'A'
                          : c >= 'a' && c <= 'z' ? c - 'a' + 26
                          : c >= '0' && c <= '9' ? c - '0' + 52
                          : c == '+'             ? 62
                          : c == '/'             ? 63
                                                 : -1;
        if (digit >= 0) {
            bits = bits << 6 | static_cast<std::uint32_t>(digit);
            held += 6;
            if (held >= 8) {
                held -= 8;
                bytes += static_cast<char>(bits >> held & 255);
            }
        } else if (c == '=') {
            held = 0;  // the next stream's first digit begins a byte
        } else if (c != ' ' && c != '\n' && c != '\r' && c != '\t') {
            break;
        }
    }
    if (bytes.size() > wanted) bytes.resize(wanted);
    return bytes;
}

/// An array as the file describes it.
struct ArrayText {
    std::string section, name, type, format;
    std::size_t components = 1, offset = 0;
    std::string_view text;  // but of appended ones

    std::string title() const { return "the array '" + (name.empty() ? section : name) + "'"; }
};

struct PieceText {
    std::size_t points = 0, cells = 0;
    std::vector<ArrayText> arrays;
};

class VtuReader {
  public:
    VtuReader(const std::string& bytes, const std::string& file, const std::string& field,
              const Inflate& inflate)
        : bytes_(bytes), file_(file), wanted_(field), inflate_(inflate) {}
    VolumeFile read();

  private:
    [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, "", message); }
    void read_head(const TagScanner& scan, const Tag& tag);
    void read_tags();
    std::size_t number_of(const TagScanner& scan, const Tag& tag, const char* key, std::size_t most) const;
    const ArrayText& array(const PieceText& piece, const std::string& section, const std::string& name) const;
    std::string stored(const ArrayText& array, std::size_t count) const;
    std::uint64_t word(const std::string& bytes, std::size_t index) const;
    std::string content(const ArrayText& array, std::size_t size) const;
    std::string unpacked(const ArrayText& array, std::size_t size) const;
    std::vector<double> values(const ArrayText& array, std::size_t count) const;
    std::vector<std::size_t> indices(const ArrayText& array, std::size_t count, std::size_t most) const;
    void add_cells(const PieceText& piece, std::size_t first_point);
    std::string chosen_field() const;

    const std::string& bytes_;
    const std::string& file_;
    const std::string& wanted_;
    const Inflate& inflate_;
    bool is_big_endian_ = false, is_packed_ = false, has_long_words_ = false, has_cell_data_ = false;
    std::vector<PieceText> pieces_;
    std::string_view appended_;
    bool is_appended_base64_ = false;
    VtkCells cells_;
};

void VtuReader::read_head(const TagScanner& scan, const Tag& tag) {
    if (tag.name != "VTKFile") scan.fail("is no file of VTK's XML format: those begin with <VTKFile");
    if (tag.attribute("type") != "UnstructuredGrid")
        scan.fail("holds '" + tag.attribute("type") + "'; UnstructuredGrid is read");
    const std::string order = tag.attribute("byte_order", "LittleEndian"),
                      words = tag.attribute("header_type", "UInt32"), packer = tag.attribute("compressor");
    if (order != "LittleEndian" && order != "BigEndian")
        scan.fail("the byte order '" + order + "' is neither LittleEndian nor BigEndian");
    if (words != "UInt32" && words != "UInt64") scan.fail("a header_type is UInt32 or UInt64");
    if (!packer.empty() && packer != "vtkZLibDataCompressor")
        scan.fail("is packed by '" + packer + "'; vtkZLibDataCompressor is read");
    is_big_endian_ = order == "BigEndian";
    has_long_words_ = words == "UInt64";
    is_packed_ = !packer.empty();
}

std::size_t VtuReader::number_of(const TagScanner& scan, const Tag& tag, const char* key,
                                 std::size_t most) const {
    const std::optional<double> value = parse_number(tag.attribute(key));
    if (!value || !(*value >= 0) || *value != std::floor(*value))
        scan.fail("'" + std::string(key) + "' of '" + tag.name + "' must be a whole number");
    if (*value > static_cast<double>(most))
        scan.fail("'" + std::string(key) + "' is " + tag.attribute(key) + ", more than " +
                  std::to_string(most));
    return static_cast<std::size_t>(*value);
}

void VtuReader::read_tags() {
    static const std::set<std::string> kSections{"FieldData", "Points", "Cells", "PointData", "CellData"};
    TagScanner scan(bytes_, file_);
    std::optional<Tag> tag = scan.next();
    if (!tag) scan.fail("is no file of VTK's XML format: those begin with <VTKFile");
    read_head(scan, *tag);
    std::string section;
    while ((tag = scan.next())) {
        if (tag->is_end) continue;
        if (tag->name == "Piece") {
            PieceText& piece = pieces_.emplace_back();
            piece.points = number_of(scan, *tag, "NumberOfPoints", kNone - 1);
            piece.cells = number_of(scan, *tag, "NumberOfCells", kMostCells);
        } else if (tag->name == "DataArray" && section != "FieldData") {
            if (pieces_.empty()) scan.fail("an array must stand within a piece");
            ArrayText array{section,
                            tag->attribute("Name"),
                            tag->attribute("type"),
                            tag->attribute("format", "ascii"),
                            1,
                            0,
                            {}};
            if (!tag->attribute("NumberOfComponents").empty())
                array.components = number_of(scan, *tag, "NumberOfComponents", 1000);
            if (array.format == "appended") array.offset = number_of(scan, *tag, "offset", bytes_.size());
            array.text = std::string_view(bytes_).substr(tag->end);
            array.text = array.text.substr(0, array.text.find('<'));
            has_cell_data_ = has_cell_data_ || section == "CellData";
            pieces_.back().arrays.push_back(std::move(array));
        } else if (tag->name == "AppendedData") {
            const std::size_t begin = bytes_.find('_', tag->end);
            if (begin == std::string::npos) scan.fail("appended data must begin with '_'");
            is_appended_base64_ = tag->attribute("encoding") == "base64";
            if (!is_appended_base64_ && tag->attribute("encoding") != "raw")
                scan.fail("appended data are raw or base64");
            appended_ = std::string_view(bytes_).substr(begin + 1);
            return;
        } else if (kSections.count(tag->name) > 0) {
            section = tag->name;
        }
    }
}

const ArrayText& VtuReader::array(const PieceText& piece, const std::string& section,
                                  const std::string& name) const {
    for (const ArrayText& one : piece.arrays)
        if (one.section == section && (name.empty() || one.name == name)) return one;
    fail("has a piece without " + (name.empty() ? "points" : "the array '" + name + "' of its cells"));
}

/// The first bytes of what the file has of an array that is no text.
std::string VtuReader::stored(const ArrayText& array, std::size_t count) const {
    std::string bytes;
    if (array.format != "appended") {
        bytes = decode_base64(array.text, count);
    } else if (array.offset <= appended_.size()) {
        const std::string_view from = appended_.substr(array.offset);
        bytes = is_appended_base64_ ? decode_base64(from, count) : std::string(from.substr(0, count));
    }
    if (bytes.size() < count)
        fail(array.title() + " is cut off: " + std::to_string(count) + " bytes are announced, " +
             std::to_string(bytes.size()) + " are there");
    return bytes;
}

std::uint64_t VtuReader::word(const std::string& bytes, std::size_t index) const {
    const std::size_t size = has_long_words_ ? 8 : 4;
    std::uint64_t value = 0;
    for (std::size_t k = 0; k < size; ++k) {
        const std::size_t at = index * size + (is_big_endian_ ? k : size - 1 - k);
        value = value << 8 | static_cast<unsigned char>(bytes[at]);
    }
    return value;
}

/// The bytes of an array that has that many: behind a word that says so.
std::string VtuReader::content(const ArrayText& array, std::size_t size) const {
    if (is_packed_) return unpacked(array, size);
    const std::size_t head = has_long_words_ ? 8 : 4;
    if (const std::uint64_t told = word(stored(array, head), 0); told != size)
        fail(array.title() + " says that it has " + std::to_string(told) + " bytes, but should have " +
             std::to_string(size) + ": the byte order, header_type, or a number is wrong");
    if (size > bytes_.size()) fail(array.title() + " is longer than the file");
    return stored(array, head + size).substr(head);
}

/// The same of blocks: their number, the size of each and of the last one (0: like the others), their packed
/// sizes, then what is packed.
std::string VtuReader::unpacked(const ArrayText& array, std::size_t size) const {
    if (size == 0) return "";
    const std::size_t each = has_long_words_ ? 8 : 4;
    const std::string head = stored(array, 3 * each);
    const std::uint64_t blocks = word(head, 0), block = word(head, 1), last = word(head, 2);
    if (blocks == 0 || blocks > size || block > size + bytes_.size() * kMostGrowth || last > block ||
        (last > 0 ? blocks - 1 : blocks) * block + last != size)
        fail(array.title() + " says that it has " + std::to_string(blocks) + " packed blocks of " +
             std::to_string(block) + " bytes, but should have " + std::to_string(size) +
             " bytes: the byte order, header_type, or a number is wrong");
    if (blocks > bytes_.size()) fail(array.title() + " has more blocks than the file has bytes");
    const std::string sizes = stored(array, (3 + blocks) * each);
    std::uint64_t sum = 0;
    for (std::uint64_t b = 0; b < blocks; ++b) {
        const std::uint64_t packed = word(sizes, 3 + b);
        if (packed > bytes_.size()) fail(array.title() + " has a block that is longer than the file");
        sum += packed;
    }
    if (sum > bytes_.size() || size > kMostGrowth * sum)
        fail(array.title() + " cannot hold " + std::to_string(size) + " bytes in " + std::to_string(sum));
    const std::string all = stored(array, (3 + blocks) * each + sum);
    std::string_view packed = std::string_view(all).substr((3 + blocks) * each);
    std::string found(size, '\0');
    std::span<char> room(found);
    for (std::uint64_t b = 0; b < blocks; ++b) {
        const std::size_t take = b + 1 == blocks && last > 0 ? last : block;
        if (!inflate_(packed.substr(0, word(sizes, 3 + b)), room.first(take)))
            fail("block " + std::to_string(b) + " of " + array.title() + " is damaged");
        packed.remove_prefix(word(sizes, 3 + b));
        room = room.subspan(take);
    }
    return found;
}

std::optional<SampleType> type_of_array(const std::string& name) {
    static const std::map<std::string, SampleType> types{
        {"Int8", SampleType::kInt8},     {"UInt8", SampleType::kUint8},   {"Int16", SampleType::kInt16},
        {"UInt16", SampleType::kUint16}, {"Int32", SampleType::kInt32},   {"UInt32", SampleType::kUint32},
        {"Int64", SampleType::kInt64},   {"UInt64", SampleType::kUint64}, {"Float32", SampleType::kFloat},
        {"Float64", SampleType::kDouble}};
    const auto found = types.find(name);
    return found == types.end() ? std::nullopt : std::optional(found->second);
}

std::vector<double> VtuReader::values(const ArrayText& array, std::size_t count) const {
    std::vector<double> values;
    if (array.format == "ascii") {
        WordScanner scan(array.text, file_);
        while (true) {
            const std::string_view word = scan.word();
            if (word.empty()) break;
            const std::optional<double> value = parse_number(word);
            if (!value) fail(array.title() + " has '" + std::string(word) + "' where a number must stand");
            values.push_back(*value);
        }
        if (values.size() != count)
            fail(array.title() + " has " + std::to_string(values.size()) + " numbers, but should have " +
                 std::to_string(count));
        return values;
    }
    if (array.format != "binary" && array.format != "appended")
        fail(array.title() + " has the format '" + array.format + "', which is none");
    const std::optional<SampleType> type = type_of_array(array.type);
    if (!type) fail(array.title() + " has numbers of the type '" + array.type + "', which is none");
    const std::string bytes = content(array, count * bytes_of(*type));
    values.reserve(count);
    for (std::size_t i = 0; i < count; ++i)
        values.push_back(number_at(bytes.data() + i * bytes_of(*type), *type, is_big_endian_));
    return values;
}

std::vector<std::size_t> VtuReader::indices(const ArrayText& array, std::size_t count,
                                            std::size_t most) const {
    std::vector<std::size_t> found;
    for (const double value : values(array, count)) {
        if (!(value >= 0 && value <= static_cast<double>(most) && value == std::floor(value)))
            fail(array.title() + " has an entry that is no whole number up to " + std::to_string(most));
        found.push_back(static_cast<std::size_t>(value));
    }
    return found;
}

void VtuReader::add_cells(const PieceText& piece, std::size_t first_point) {
    if (piece.cells == 0) return;
    const std::size_t before = cells_.corners.size();
    std::size_t last = 0;
    constexpr std::size_t kMostCorners = 4'000'000'000, kMostType = 255;
    for (const std::size_t end : indices(array(piece, "Cells", "offsets"), piece.cells, kMostCorners)) {
        if (end < last) fail("has offsets of cells that do not rise");
        last = end;
        cells_.first_corner.push_back(before + end);
    }
    if (piece.points == 0) fail("has a piece of cells without points");
    for (const std::size_t corner : indices(array(piece, "Cells", "connectivity"), last, piece.points - 1))
        cells_.corners.push_back(static_cast<Id>(first_point + corner));
    for (const std::size_t type : indices(array(piece, "Cells", "types"), piece.cells, kMostType))
        cells_.types.push_back(static_cast<int>(type));
}

/// The first of one component that all pieces have.
std::string VtuReader::chosen_field() const {
    std::vector<std::string> others;
    for (const ArrayText& one : pieces_.front().arrays) {
        if (one.section != "PointData") continue;
        if (one.components == 1 && (wanted_.empty() || one.name == wanted_)) return one.name;
        if (one.name == wanted_)
            fail("the field '" + wanted_ + "' has " + std::to_string(one.components) +
                 " components; a scalar has one");
        others.push_back(one.name);
    }
    fail_for_field(file_, wanted_, others, has_cell_data_);
}

VolumeFile VtuReader::read() {
    read_tags();
    if (pieces_.empty()) fail("has no piece");
    VolumeFile result;
    result.field = chosen_field();
    cells_.first_corner.push_back(0);
    std::vector<Vec3> points;
    std::vector<double> scalars;
    for (const PieceText& piece : pieces_) {
        if (points.size() + piece.points >= kNone) fail("has more points than can be numbered");
        add_cells(piece, points.size());
        const std::vector<double> places = values(array(piece, "Points", ""), 3 * piece.points);
        for (std::size_t i = 0; i < piece.points; ++i) {
            points.emplace_back(places[3 * i], places[3 * i + 1], places[3 * i + 2]);
            for (int k = 0; k < 3; ++k)
                if (!(std::fabs(points.back()[k]) <= 1e30))
                    fail("point " + std::to_string(points.size() - 1) +
                         " has a coordinate that is no number up to 1e30");
        }
        for (const double value : values(array(piece, "PointData", result.field), piece.points)) {
            if (!std::isfinite(value))
                fail("the field '" + result.field + "' is not finite at point " +
                     std::to_string(scalars.size()));
            scalars.push_back(value);
        }
    }
    CellSoup soup = soup_of_vtk(cells_, std::move(points), file_, result.warnings);
    soup.scalars = std::move(scalars);
    result.cells = std::move(soup);
    return result;
}

}  // namespace

VolumeFile parse_vtu(const std::string& bytes, const std::string& file, const std::string& field,
                     const Inflate& inflate) {
    return VtuReader(bytes, file, field, inflate).read();
}

}  // namespace trilens
