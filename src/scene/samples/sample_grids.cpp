// Regular grids of samples: NRRD headers, and samples as they lie in memory.
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "base/util/error.h"
#include "base/util/names.h"
#include "scene/formats/line_scanner.h"
#include "scene/samples/volume_file.h"

namespace trilens {
namespace {

void check_finite(const std::vector<double>& samples, const std::array<std::size_t, 3>& size,
                  const std::string& file) {
    for (std::size_t i = 0; i < samples.size(); ++i)
        if (!std::isfinite(samples[i]))
            throw InputError(file, "",
                             "sample " + std::to_string(i % size[0]) + ", " +
                                 std::to_string(i / size[0] % size[1]) + ", " +
                                 std::to_string(i / size[0] / size[1]) + " is not finite");
}

}  // namespace

const std::vector<std::string>& sample_type_names() {
    static const std::vector<std::string> names{"uint8", "int8",  "uint16", "int16",  "uint32",
                                                "int32", "float", "double", "uint64", "int64"};
    return names;
}

std::size_t checked_point_count(const std::array<std::size_t, 3>& size, const std::string& file,
                                const std::string& place) {
    double boxes = 6;
    for (const std::size_t side : size) {
        if (side < 2) throw InputError(file, place, "a grid has at least 2 points along each axis");
        boxes *= static_cast<double>(side - 1);
    }
    if (boxes > static_cast<double>(kMostCells))
        throw InputError(file, place,
                         "the grid has " + std::to_string(static_cast<long long>(std::min(boxes, 9e18))) +
                             " tetrahedra, more than " + std::to_string(kMostCells) + ": take fewer samples");
    return size[0] * size[1] * size[2];
}

std::vector<double> decode_samples(std::string_view bytes, const std::string& file,
                                   const std::array<std::size_t, 3>& size, const SampleLayout& layout) {
    const std::size_t count = size[0] * size[1] * size[2], each = bytes_of(layout.type);
    const std::size_t given = bytes.size() - std::min(bytes.size(), layout.skip);
    if (given != count * each)
        throw InputError(
            file, "",
            "has " + std::to_string(given) + " bytes of samples" +
                (layout.skip > 0 ? " after the " + std::to_string(layout.skip) + " skipped" : "") + ", but " +
                std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]) +
                " samples of " + std::to_string(each) + " bytes are " + std::to_string(count * each));
    std::vector<double> samples(count);
    for (std::size_t i = 0; i < count; ++i)
        samples[i] = number_at(bytes.data() + layout.skip + i * each, layout.type, layout.big_endian);
    check_finite(samples, size, file);
    return samples;
}

namespace {

/// "(1,0,0)"
std::optional<Vec3> parse_vector(std::string_view text) {
    if (text.size() < 2 || text.front() != '(' || text.back() != ')') return std::nullopt;
    std::string inside(text.substr(1, text.size() - 2));
    for (char& letter : inside)
        if (letter == ',') letter = ' ';
    const std::vector<std::string_view> words = split_words(inside);
    if (words.size() != 3) return std::nullopt;
    Vec3 v;
    for (int k = 0; k < 3; ++k) {
        const std::optional<double> part = parse_number(words[static_cast<std::size_t>(k)]);
        if (!part || !(std::fabs(*part) <= 1e30)) return std::nullopt;
        v[k] = *part;
    }
    return v;
}

std::optional<SampleType> nrrd_type(const std::string& name) {
    const struct {
        SampleType type;
        std::vector<std::string> names;
    } kTypes[]{
        {SampleType::kUint8, {"uchar", "unsigned char", "uint8", "uint8_t"}},
        {SampleType::kInt8, {"signed char", "int8", "int8_t"}},
        {SampleType::kUint16, {"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}},
        {SampleType::kInt16, {"short", "short int", "signed short", "signed short int", "int16", "int16_t"}},
        {SampleType::kUint32, {"uint", "unsigned int", "uint32", "uint32_t"}},
        {SampleType::kInt32, {"int", "signed int", "int32", "int32_t"}},
        {SampleType::kFloat, {"float"}},
        {SampleType::kDouble, {"double"}},
        {SampleType::kUint64,
         {"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"}},
        {SampleType::kInt64,
         {"longlong", "long long", "long long int", "signed long long", "signed long long int", "int64",
          "int64_t"}}};
    for (const auto& [type, names] : kTypes)
        for (const std::string& one : names)
            if (one == name) return type;
    return std::nullopt;
}

class NrrdReader {
  public:
    NrrdReader(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {}
    RegularGrid read(const ReadBeside& read_beside, const Inflate& inflate);

  private:
    std::string unpacked(std::string_view samples, const Inflate& inflate) const;
    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file_, "line " + std::to_string(line_), message);
    }
    bool next_line(std::string& line);
    void read_key(const std::string& key, const std::string& value);
    void read_steps(const std::string& key, const std::vector<std::string_view>& words);
    void read_least(std::span<const std::string_view> words);
    std::vector<double> text_samples(std::string_view text) const;

    const std::string& bytes_;
    const std::string& file_;
    std::size_t at_ = 0, line_ = 0;
    RegularGrid grid_;
    SampleLayout layout_;
    std::string encoding_, data_file_;
    std::array<double, 3> least_{};
    std::array<bool, 3> of_cells_{};  // samples are the middles of cells, as `axis mins` counts
    bool has_type_ = false, has_sizes_ = false, has_endian_ = false, has_least_ = false;
};

bool NrrdReader::next_line(std::string& line) {
    if (at_ >= bytes_.size()) return false;
    const std::size_t end = std::min(bytes_.find('\n', at_), bytes_.size());
    line = bytes_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return true;
}

void NrrdReader::read_steps(const std::string& key, const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail("'" + key + "' must have three entries");
    for (std::size_t k = 0; k < 3; ++k) {
        const int axis = static_cast<int>(k);
        if (key == "spacings") {
            const std::optional<double> step = parse_number(words[k]);
            if (!step || !(*step > 0) || !(*step <= 1e30)) fail("a spacing must be a positive number");
            grid_.steps[axis] = Vec3(0);
            grid_.steps[axis][axis] = *step;
        } else {
            const std::optional<Vec3> step = parse_vector(words[k]);
            if (!step) fail("a space direction must be three numbers in brackets");
            grid_.steps[axis] = *step;
        }
    }
    if (glm::determinant(grid_.steps) == 0) fail("the space directions lie in a plane");
}

/// Along each axis the place of its first sample or, where samples are cells' middles, where its cell begins.
void NrrdReader::read_least(std::span<const std::string_view> words) {
    if (words.size() != 3) fail("'axis mins' must have three entries");
    for (std::size_t k = 0; k < 3; ++k) {
        const std::optional<double> least = parse_number(words[k]);
        if (!least || !(std::fabs(*least) <= 1e30)) fail("the least place along an axis must be a number");
        least_[k] = *least;
    }
    has_least_ = true;
}

void NrrdReader::read_key(const std::string& key, const std::string& value) {
    const std::vector<std::string_view> words = split_words(value);
    if (key == "dimension") {
        if (value != "3") fail("has dimension " + value + "; three are read");
    } else if (key == "type") {
        const std::optional<SampleType> type = nrrd_type(value);
        if (!type) fail("samples of type '" + value + "' are not known here");
        layout_.type = *type;
        has_type_ = true;
    } else if (key == "sizes") {
        if (words.size() != 3) fail("'sizes' must be three");
        for (std::size_t k = 0; k < 3; ++k) {
            const std::optional<int> side = parse_integer(words[k]);
            if (!side || *side < 0) fail("a size must be a whole number");
            grid_.size[k] = static_cast<std::size_t>(*side);
        }
        checked_point_count(grid_.size, file_, "line " + std::to_string(line_));
        has_sizes_ = true;
    } else if (key == "spacings" || key == "space directions") {
        read_steps(key, words);
    } else if (key == "axis mins" || key == "axismins") {
        read_least(words);
    } else if (key == "centers" || key == "centerings") {
        for (std::size_t k = 0; k < std::min<std::size_t>(3, words.size()); ++k)
            of_cells_[k] = words[k] == "cell";
    } else if (key == "space origin") {
        const std::optional<Vec3> origin = parse_vector(value);
        if (!origin) fail("the space origin must be three numbers in brackets");
        grid_.origin = *origin;
    } else if (key == "encoding") {
        encoding_ = value;
    } else if (key == "endian") {
        if (value != "little" && value != "big") fail("'endian' must be little or big");
        layout_.big_endian = value == "big";
        has_endian_ = true;
    } else if (key == "data file" || key == "datafile") {
        if (words.empty() || words[0] == "LIST" || value.find('%') != std::string::npos)
            fail("'" + key + "' must name one file: samples in several files are not read");
        data_file_ = value;
    } else if (key == "byte skip" || key == "byteskip") {
        const std::optional<int> skip = parse_integer(value);
        if (!skip || *skip < 0) fail("'byte skip' must be a number of bytes");
        layout_.skip = static_cast<std::size_t>(*skip);
    } else if ((key == "line skip" || key == "lineskip") && value != "0") {
        fail("lines before the samples are not skipped here");
    }
}

std::vector<double> NrrdReader::text_samples(std::string_view text) const {
    std::string words(text);
    for (char& letter : words)
        if (letter == '\n' || letter == ',') letter = ' ';
    std::vector<double> samples;
    for (const std::string_view word : split_words(words)) {
        const std::optional<double> value = parse_number(word);
        if (!value) throw InputError(file_, "", "a number must stand where '" + std::string(word) + "' does");
        samples.push_back(*value);
    }
    const std::size_t count = grid_.size[0] * grid_.size[1] * grid_.size[2];
    if (samples.size() != count)
        throw InputError(
            file_, "",
            "has " + std::to_string(samples.size()) + " samples, but its sizes say " + std::to_string(count));
    check_finite(samples, grid_.size, file_);
    return samples;
}

/// What gzip packed: `byte skip` and the samples.
std::string NrrdReader::unpacked(std::string_view samples, const Inflate& inflate) const {
    constexpr std::size_t kMostSkipped = 1 << 20;
    if (layout_.skip > kMostSkipped) fail("'byte skip' passes more than 1 MiB of packed bytes");
    std::string bytes(layout_.skip + grid_.size[0] * grid_.size[1] * grid_.size[2] * bytes_of(layout_.type),
                      '\0');
    if (!inflate(samples, bytes))
        throw InputError(file_, "",
                         "holds no gzip stream of " + std::to_string(bytes.size()) +
                             " bytes, as its sizes say: it is damaged or truncated");
    return bytes;
}

RegularGrid NrrdReader::read(const ReadBeside& read_beside, const Inflate& inflate) {
    std::string line;
    if (!next_line(line) || !line.starts_with("NRRD000")) {
        line_ = 1;
        fail("is no NRRD file: those begin with 'NRRD000'");
    }
    while (next_line(line) && !line.empty()) {
        if (line[0] == '#') continue;
        const std::size_t colon = line.find(':');
        if (colon == std::string::npos) fail("a field must be 'name: value'");
        if (colon + 1 < line.size() && line[colon + 1] == '=') continue;  // a key of somebody's own
        const std::string_view rest = std::string_view(line).substr(colon + 1);
        read_key(line.substr(0, colon), rest_of_line(rest, rest.substr(0, 0)));
    }
    if (!has_type_ || !has_sizes_ || encoding_.empty()) fail("needs type, sizes and encoding");
    if (has_least_)
        for (int k = 0; k < 3; ++k) {
            const auto axis = static_cast<std::size_t>(k);
            grid_.origin[k] = least_[axis] + (of_cells_[axis] ? 0.5 * grid_.steps[k][k] : 0.0);
        }
    std::string detached;
    std::string_view samples = std::string_view(bytes_).substr(std::min(at_, bytes_.size()));
    if (!data_file_.empty()) {
        detached = read_beside(data_file_);
        samples = detached;
    }
    const bool is_packed = encoding_ == "gzip" || encoding_ == "gz";
    if (encoding_ == "raw" || is_packed) {
        if (bytes_of(layout_.type) > 1 && !has_endian_) fail("samples of several bytes need 'endian'");
        const std::string bytes = is_packed ? unpacked(samples, inflate) : std::string();
        grid_.scalars = decode_samples(is_packed ? bytes : samples, file_, grid_.size, layout_);
    } else if (encoding_ == "ascii" || encoding_ == "text" || encoding_ == "txt") {
        grid_.scalars = text_samples(samples);
    } else {
        fail("samples in the encoding '" + encoding_ + "' are not read: raw, gzip and ascii are");
    }
    return std::move(grid_);
}

}  // namespace

RegularGrid parse_nrrd(const std::string& bytes, const std::string& file, const ReadBeside& read_beside,
                       const Inflate& inflate) {
    return NrrdReader(bytes, file).read(read_beside, inflate);
}

}  // namespace trilens
