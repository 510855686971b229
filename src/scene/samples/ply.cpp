// Points and their colours out of PLY files, ASCII or binary of either byte order. Source: Turk, The PLY
// Polygon File Format, 1994.
#include <array>
#include <cmath>
#include <optional>

#include "base/math/srgb.h"
#include "base/util/error.h"
#include "scene/data/scene.h"
#include "scene/formats/line_scanner.h"
#include "scene/samples/binary_numbers.h"
#include "scene/samples/point_cloud.h"

namespace trilens {
namespace {

constexpr struct {
    SampleType type;
    std::array<const char*, 2> names;
} kPlyTypes[]{{SampleType::kInt8, {"char", "int8"}},      {SampleType::kUint8, {"uchar", "uint8"}},
              {SampleType::kInt16, {"short", "int16"}},   {SampleType::kUint16, {"ushort", "uint16"}},
              {SampleType::kInt32, {"int", "int32"}},     {SampleType::kUint32, {"uint", "uint32"}},
              {SampleType::kFloat, {"float", "float32"}}, {SampleType::kDouble, {"double", "float64"}}};

std::optional<SampleType> type_named(std::string_view name) {
    for (const auto& [type, names] : kPlyTypes)
        if (name == names[0] || name == names[1]) return type;
    return std::nullopt;
}

std::string name_of_type(SampleType wanted) {
    for (const auto& [type, names] : kPlyTypes)
        if (type == wanted) return names[0];
    return "";
}

bool is_fraction(SampleType type) {
    return type == SampleType::kFloat || type == SampleType::kDouble;
}

/// Whether a number that is written out is one of a whole type.
bool fits_type(double number, SampleType type) {
    const bool has_sign =
        type == SampleType::kInt8 || type == SampleType::kInt16 || type == SampleType::kInt32;
    const double values = std::ldexp(1.0, 8 * static_cast<int>(bytes_of(type)));
    const double least = has_sign ? -values / 2 : 0;
    return number >= least && number < least + values && number == std::floor(number);
}

struct Property {
    std::string name;
    SampleType type = SampleType::kFloat;
    std::optional<SampleType> count;  // of a list: its length's
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;

    std::size_t find(std::initializer_list<const char*> names) const {
        for (std::size_t i = 0; i < properties.size(); ++i)
            for (const char* one : names)
                if (properties[i].name == one && !properties[i].count) return i;
        return properties.size();
    }
};

enum class PlyForm { kAscii, kLittle, kBig };

class PlyReader {
  public:
    PlyReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

    ColoredPoints read() {
        read_header();
        for (const Element& element : elements_) {
            if (element.name == "vertex") return read_vertices(element);
            std::vector<double> row;
            for (std::size_t i = 0; i < element.count; ++i) read_row(element, row);
        }
        fail("has no element vertex");
    }

  private:
    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file_, line_ > 0 ? "line " + std::to_string(line_) : "", message);
    }

    std::string_view next_line() {
        if (at_ >= bytes_.size()) fail("ends in its header");
        const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
        std::string_view line = bytes_.substr(at_, end - at_);
        if (line.ends_with('\r')) line.remove_suffix(1);
        at_ = std::min(end + 1, bytes_.size());
        ++line_;
        return line;
    }

    void read_header();
    void read_format(std::span<const std::string_view> words);
    void read_property(std::span<const std::string_view> words);
    ColoredPoints read_vertices(const Element& element);
    void read_row(const Element& element, std::vector<double>& row);
    double next_number(SampleType type);

    std::string_view bytes_;
    const std::string& file_;
    std::size_t at_ = 0, line_ = 0;
    std::optional<PlyForm> form_;
    std::vector<Element> elements_;
};

void PlyReader::read_format(std::span<const std::string_view> words) {
    if (words.size() == 3 && words[2] == "1.0") {
        if (words[1] == "ascii") form_ = PlyForm::kAscii;
        if (words[1] == "binary_little_endian") form_ = PlyForm::kLittle;
        if (words[1] == "binary_big_endian") form_ = PlyForm::kBig;
    }
    if (!form_) fail("the format is none of ascii, binary_little_endian and binary_big_endian 1.0");
}

void PlyReader::read_property(std::span<const std::string_view> words) {
    if (elements_.empty()) fail("has a property before any element");
    Property property;
    const bool is_list = words.size() == 5 && words[1] == "list";
    if (!is_list && words.size() != 3) fail("needs 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    if (is_list) {
        property.count = type_named(words[2]);
        if (!property.count || is_fraction(*property.count))
            fail("'" + std::string(words[2]) + "' is no type that counts");
    }
    const std::string_view type = words[words.size() - 2];
    const std::optional<SampleType> known = type_named(type);
    if (!known) fail("'" + std::string(type) + "' is no type of PLY");
    property.type = *known;
    property.name = words.back();
    elements_.back().properties.push_back(std::move(property));
}

void PlyReader::read_header() {
    if (next_line() != "ply") fail("is no PLY file");
    while (true) {
        const std::string_view line = next_line();
        const std::vector<std::string_view> words = split_words(line);
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "end_header") break;
        if (words[0] == "format") {
            read_format(words);
        } else if (words[0] == "element") {
            const std::optional<double> count =
                words.size() == 3 ? parse_number(words[2]) : std::optional<double>();
            if (!count || !(*count >= 0 && *count <= 4e9) || *count != std::floor(*count))
                fail("needs 'element NAME COUNT'");
            elements_.push_back({std::string(words[1]), static_cast<std::size_t>(*count), {}});
        } else if (words[0] == "property") {
            read_property(words);
        } else {
            fail("'" + std::string(words[0]) + "' is no word of a PLY header");
        }
    }
    if (!form_) fail("its header names no format");
    if (form_ != PlyForm::kAscii) line_ = 0;
}

double PlyReader::next_number(SampleType type) {
    if (form_ == PlyForm::kAscii) {
        while (at_ < bytes_.size() && std::isspace(static_cast<unsigned char>(bytes_[at_])))
            line_ += bytes_[at_++] == '\n';
        const std::size_t begin = at_;
        while (at_ < bytes_.size() && !std::isspace(static_cast<unsigned char>(bytes_[at_]))) ++at_;
        if (begin == at_) fail("ends before all that its header counts");
        const std::optional<double> number = parse_number(bytes_.substr(begin, at_ - begin));
        if (!number) fail("'" + std::string(bytes_.substr(begin, at_ - begin)) + "' is no number");
        if (!is_fraction(type) && !fits_type(*number, type))
            fail("'" + std::string(bytes_.substr(begin, at_ - begin)) + "' is no " + name_of_type(type));
        return *number;
    }
    const std::size_t size = bytes_of(type);
    if (bytes_.size() - at_ < size) fail("ends before all that its header counts");
    at_ += size;
    return number_at(bytes_.data() + at_ - size, type, form_ == PlyForm::kBig);
}

/// One number per property, a list's 0.
void PlyReader::read_row(const Element& element, std::vector<double>& row) {
    row.clear();
    for (const Property& property : element.properties) {
        if (!property.count) {
            row.push_back(next_number(property.type));
            continue;
        }
        const double entries = next_number(*property.count);
        if (!(entries >= 0)) fail("has a list of negative length");
        for (double k = 0; k < entries; ++k) next_number(property.type);
        row.push_back(0);
    }
}

bool is_color(SampleType type) {
    return type == SampleType::kUint8 || type == SampleType::kUint16 || is_fraction(type);
}

/// Whole numbers are sRGB, as scanners write them; others are linear.
double linear_color(double value, SampleType type) {
    if (is_fraction(type)) return value;
    return linear_from_srgb(value / (type == SampleType::kUint8 ? 255 : 65535));
}

ColoredPoints PlyReader::read_vertices(const Element& element) {
    const std::size_t none = element.properties.size();
    const std::array<std::size_t, 3> place{element.find({"x"}), element.find({"y"}), element.find({"z"})};
    const std::array<std::size_t, 3> color{element.find({"red", "diffuse_red"}),
                                           element.find({"green", "diffuse_green"}),
                                           element.find({"blue", "diffuse_blue"})};
    if (place[0] == none || place[1] == none || place[2] == none) fail("its vertices have no x, y and z");
    if (element.count == 0) fail("holds no points");
    if (element.count > kMostPoints)
        fail("has " + std::to_string(element.count) + " points, more than " + std::to_string(kMostPoints));
    // Each number takes a byte at the least, and as text a blank too: a header that counts more lies.
    if (element.count > bytes_.size() / 3) fail("ends before all that its header counts");
    const bool colored = color[0] != none && color[1] != none && color[2] != none;
    for (const std::size_t k : color)
        if (colored && !is_color(element.properties[k].type))
            fail("'" + element.properties[k].name + "' is " + name_of_type(element.properties[k].type) +
                 ": colours are uchar, ushort, float or double");
    ColoredPoints points;
    std::vector<double> row;
    for (std::size_t i = 0; i < element.count; ++i) {
        read_row(element, row);
        const Vec3 at(row[place[0]], row[place[1]], row[place[2]]);
        for (int k = 0; k < 3; ++k)
            if (!(std::fabs(at[k]) <= kLargestCoordinate))
                fail("vertex " + std::to_string(i) + " has a coordinate that is no number up to 1e30");
        points.points.push_back(at);
        if (!colored) continue;
        Vec3 own;
        for (std::size_t k = 0; k < 3; ++k) {
            own[static_cast<int>(k)] = linear_color(row[color[k]], element.properties[color[k]].type);
            if (!(own[static_cast<int>(k)] >= 0 && own[static_cast<int>(k)] <= kLargestCoordinate))
                fail("vertex " + std::to_string(i) + " has a colour that is negative or no number");
        }
        points.colors.push_back(own);
    }
    return points;
}

}  // namespace

ColoredPoints parse_ply(std::string_view bytes, const std::string& file) {
    return PlyReader(bytes, file).read();
}

}  // namespace trilens
