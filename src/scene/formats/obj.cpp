// One pass over the lines of an OBJ, each error with its line.
#include "scene/formats/obj.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>

#include "base/math/srgb.h"
#include "base/util/error.h"
#include "json/json.h"
#include "scene/formats/line_scanner.h"

namespace trilens {
namespace {

constexpr std::size_t kMostCorners = 255;  // OpenSubdiv's and tinyobjloader's limit too

using Words = std::vector<std::string_view>;

/// A face corner: indices into points, texture coordinates and normals; -1 where there is none.
struct Corner {
    int point = -1, uv = -1, normal = -1;
};

/// One `t` line.
struct Tag {
    std::string name;
    std::vector<int> integers;
    std::vector<double> reals;
};

class ObjReader {
  public:
    explicit ObjReader(const std::string& file) : file_(file) {}

    void read_line(std::string_view line, std::size_t number) {
        line_ = number;
        const Words words = split_words(line);
        if (words.empty()) return;
        const std::string_view keyword = words[0];
        if (keyword == "v")
            read_point(words);
        else if (keyword == "vt")
            read_uv(words);
        else if (keyword == "vn")
            normals_.push_back(read_vec3(words));
        else if (keyword == "f")
            read_face(words);
        else if (keyword == "t")
            apply_tag(read_tag(words));
        else if (keyword == "usemtl")
            use_material(rest_of_line(line, keyword));
        else if (keyword == "mtllib")
            result_.material_libraries.push_back(rest_of_line(line, keyword));
        else if (keyword == "l" || keyword == "p")
            ++skipped_;
    }

    ObjFile finish();

  private:
    [[noreturn]] void fail(std::size_t line, const std::string& message) const {
        throw InputError(file_, "line " + std::to_string(line), message);
    }
    [[noreturn]] void fail(const std::string& message) const { fail(line_, message); }
    void warn(const std::string& message) {
        result_.warnings.push_back("line " + std::to_string(line_) + ": " + message);
    }

    double read_number(std::string_view word) const {
        const std::optional<double> value = parse_number(word);
        if (!value || std::isnan(*value)) fail("'" + std::string(word) + "' is no number");
        if (!(std::abs(*value) <= kLargestCoordinate))
            fail("'" + std::string(word) + "' is beyond the limit of 1e30");
        return *value;
    }

    int read_integer(std::string_view word) const {
        const std::optional<int> value = parse_integer(word);
        if (!value) fail("'" + std::string(word) + "' is no integer");
        return *value;
    }

    Vec3 read_vec3(const Words& words) const {
        if (words.size() < 4)
            fail("'" + std::string(words[0]) + "' needs 3 numbers, found " +
                 std::to_string(words.size() - 1));
        return {read_number(words[1]), read_number(words[2]), read_number(words[3])};
    }

    /// Three coordinates, then perhaps a colour, which other programs write as screens have it (sRGB).
    void read_point(const Words& words) {
        std::vector<Vec3>& points = result_.mesh.cage.points;
        points.push_back(read_vec3(words));
        if (words.size() != 7) return;
        Vec4 color(1);
        for (int k = 0; k < 3; ++k) {
            const double value = read_number(words[static_cast<std::size_t>(4 + k)]);
            if (!(value >= 0 && value <= 1)) fail("a point's colour must lie in 0..1");
            color[k] = linear_from_srgb(value);
        }
        point_colors_.resize(points.size() - 1, Vec4(1));
        point_colors_.push_back(color);
    }

    void read_uv(const Words& words) {
        if (words.size() < 2) fail("'vt' needs a number");
        uvs_.push_back({read_number(words[1]), words.size() > 2 ? read_number(words[2]) : 0});
    }

    /// One of the indices of a corner, from 0. It may name what comes later in the file: see finish.
    int read_index(std::string_view word, std::size_t so_far) const {
        const int index = read_integer(word);
        if (index == 0) fail("index 0: indices count from 1");
        if (index > 0) return index - 1;
        if (static_cast<std::size_t>(-static_cast<long long>(index)) > so_far)
            fail("index " + std::to_string(index) + " is out of range: there are " + std::to_string(so_far) +
                 " so far");
        return static_cast<int>(so_far) + index;
    }

    Corner read_corner(std::string_view word) const {
        Corner corner;
        const std::size_t first = word.find('/');
        corner.point = read_index(word.substr(0, first), result_.mesh.cage.points.size());
        if (first == std::string_view::npos) return corner;
        const std::string_view rest = word.substr(first + 1);
        const std::size_t second = rest.find('/');
        if (second != 0 && !rest.empty()) corner.uv = read_index(rest.substr(0, second), uvs_.size());
        if (second != std::string_view::npos && second + 1 < rest.size())
            corner.normal = read_index(rest.substr(second + 1), normals_.size());
        return corner;
    }

    void read_face(const Words& words) {
        const std::size_t corners = words.size() - 1;
        if (corners < 3) fail("a face needs at least 3 corners, found " + std::to_string(corners));
        if (corners > kMostCorners)
            fail("a face may have at most " + std::to_string(kMostCorners) + " corners, found " +
                 std::to_string(corners));
        for (std::size_t k = 1; k < words.size(); ++k) corners_.push_back(read_corner(words[k]));
        result_.mesh.cage.face_vertex_counts.push_back(static_cast<int>(corners));
        result_.mesh.face_material.push_back(material_);
        face_line_.push_back(line_);
    }

    void use_material(const std::string& name) {
        auto& names = result_.material_names;
        const auto found = std::find(names.begin(), names.end(), name);
        material_ = static_cast<Id>(found - names.begin());
        if (found == names.end()) names.push_back(name);
    }

    Tag read_tag(const Words& words) const;
    void apply_tag(const Tag& tag);
    void set_boundary(int code);
    void check_faces() const;
    void check_tags() const;
    void resolve_corners();

    const std::string& file_;
    ObjFile result_;
    std::size_t line_ = 0, skipped_ = 0;
    std::vector<Vec2> uvs_;
    std::vector<Vec3> normals_;
    std::vector<Vec4> point_colors_;  // of the first points; empty where none has any
    std::vector<Corner> corners_;
    std::vector<std::size_t> face_line_;
    Id material_ = kNone;

    struct TagIndex {
        int index;
        bool is_face;
        std::size_t line;
    };
    std::vector<TagIndex> tag_indices_;
};

Tag ObjReader::read_tag(const Words& words) const {
    if (words.size() < 3) fail("a tag is 't NAME INTS/REALS/STRINGS values...'");
    std::array<std::size_t, 3> sizes{};
    std::string_view counts = words[2];
    for (std::size_t& size : sizes) {
        const std::size_t slash = counts.find('/');
        const int count = read_integer(counts.substr(0, slash));
        if (count < 0) fail("a tag's counts must not be negative");
        size = static_cast<std::size_t>(count);
        if (slash == std::string_view::npos) break;
        counts.remove_prefix(slash + 1);
    }
    if (words.size() != 3 + sizes[0] + sizes[1] + sizes[2])
        fail("the tag announces " + std::string(words[2]) + " values, found " +
             std::to_string(words.size() - 3));
    Tag tag;
    tag.name = words[1];
    for (std::size_t k = 0; k < sizes[0]; ++k) tag.integers.push_back(read_integer(words[3 + k]));
    for (std::size_t k = 0; k < sizes[1]; ++k) tag.reals.push_back(read_number(words[3 + sizes[0] + k]));
    return tag;
}

void ObjReader::apply_tag(const Tag& tag) {
    Cage& cage = result_.mesh.cage;
    const std::size_t integers = tag.integers.size(), reals = tag.reals.size();
    const auto expect = [&](bool right) {
        if (!right) fail("the tag '" + tag.name + "' has the wrong number of values");
    };
    const auto sharpness = [&](std::size_t k) { return tag.reals[reals == 1 ? 0 : k]; };
    for (const double value : tag.reals)
        if (value < 0) fail("a sharpness must not be negative");

    if (tag.name == "crease") {
        expect(integers >= 2 && integers % 2 == 0 && (reals == 1 || reals == integers / 2));
        if (integers > 2) warn("a crease tag of several points is read as pairs");
        cage.crease_indices.insert(cage.crease_indices.end(), tag.integers.begin(), tag.integers.end());
        cage.crease_lengths.insert(cage.crease_lengths.end(), integers / 2, 2);
        for (std::size_t k = 0; k < integers / 2; ++k) cage.crease_sharpnesses.push_back(sharpness(k));
    } else if (tag.name == "corner") {
        expect(integers >= 1 && (reals == 1 || reals == integers));
        cage.corner_indices.insert(cage.corner_indices.end(), tag.integers.begin(), tag.integers.end());
        for (std::size_t k = 0; k < integers; ++k) cage.corner_sharpnesses.push_back(sharpness(k));
    } else if (tag.name == "hole") {
        cage.hole_indices.insert(cage.hole_indices.end(), tag.integers.begin(), tag.integers.end());
    } else if (tag.name == "interpolateboundary") {
        expect(integers == 1);
        return set_boundary(tag.integers[0]);
    } else {
        return warn("the tag '" + tag.name + "' is ignored");
    }
    for (const int index : tag.integers) tag_indices_.push_back({index, tag.name == "hole", line_});
}

void ObjReader::set_boundary(int code) {
    if (code < 0 || code > 2) fail("interpolateboundary must be 0, 1 or 2");
    result_.mesh.cage.interpolate_boundary = code == 0   ? InterpolateBoundary::kNothing
                                             : code == 1 ? InterpolateBoundary::kEdgeAndCorner
                                                         : InterpolateBoundary::kEdgeOnly;
}

void ObjReader::check_faces() const {
    const Cage& cage = result_.mesh.cage;
    const auto check = [&](int index, std::size_t count, std::size_t face, const char* what) {
        if (index >= 0 && static_cast<std::size_t>(index) >= count)
            fail(face_line_[face], "index " + std::to_string(index + 1) + " is out of range: there are " +
                                       std::to_string(count) + " " + what);
    };
    std::size_t first = 0;
    for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face) {
        const std::size_t end = first + static_cast<std::size_t>(cage.face_vertex_counts[face]);
        for (; first < end; ++first) {
            check(corners_[first].point, cage.points.size(), face, "points");
            check(corners_[first].uv, uvs_.size(), face, "texture coordinates");
            check(corners_[first].normal, normals_.size(), face, "normals");
        }
    }
}

void ObjReader::check_tags() const {
    const Cage& cage = result_.mesh.cage;
    for (const TagIndex& tag : tag_indices_) {
        const std::size_t count = tag.is_face ? cage.face_vertex_counts.size() : cage.points.size();
        if (tag.index < 0 || static_cast<std::size_t>(tag.index) >= count)
            fail(tag.line, "index " + std::to_string(tag.index) + " is out of range: there are " +
                               std::to_string(count) + (tag.is_face ? " faces" : " points") +
                               ", counted from 0 in tags");
    }
}

void ObjReader::resolve_corners() {
    PolygonMesh& mesh = result_.mesh;
    const bool has_uvs =
        std::any_of(corners_.begin(), corners_.end(), [](const Corner& c) { return c.uv >= 0; });
    const bool has_normals =
        std::any_of(corners_.begin(), corners_.end(), [](const Corner& c) { return c.normal >= 0; });
    if (!point_colors_.empty()) point_colors_.resize(mesh.cage.points.size(), Vec4(1));
    for (const Corner& corner : corners_) {
        if (!point_colors_.empty())
            mesh.colors.push_back(point_colors_[static_cast<std::size_t>(corner.point)]);
        mesh.cage.face_vertex_indices.push_back(corner.point);
        if (has_uvs) mesh.uvs.push_back(corner.uv < 0 ? Vec2(0) : uvs_[static_cast<std::size_t>(corner.uv)]);
        if (has_normals)
            mesh.normals.push_back(corner.normal < 0 ? Vec3(0)
                                                     : normals_[static_cast<std::size_t>(corner.normal)]);
    }
}

ObjFile ObjReader::finish() {
    if (corners_.empty()) throw InputError(file_, "", "no faces: an OBJ without an 'f' line cannot be drawn");
    check_faces();
    check_tags();
    resolve_corners();
    if (skipped_ > 0)
        result_.warnings.push_back(std::to_string(skipped_) +
                                   " lines or points are skipped: only faces are drawn");
    return std::move(result_);
}

}  // namespace

ObjFile parse_obj(const std::string& bytes, const std::string& file) {
    const std::string_view text = utf8_text(bytes, file);
    ObjReader reader(file);
    std::string joined;  // lines that end in a backslash, so far
    std::size_t line = 0, begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string_view part(text.data() + begin, end - begin);
        begin = end + 1;
        ++line;
        while (!part.empty() && part.back() == '\r') part.remove_suffix(1);
        const bool goes_on = !part.empty() && part.back() == '\\';
        if (goes_on || !joined.empty()) {
            joined.append(part.substr(0, part.size() - (goes_on ? 1 : 0))) += ' ';
            if (goes_on && begin < text.size()) continue;
            part = joined;
        }
        reader.read_line(part, line);
        joined.clear();
    }
    return reader.finish();
}

}  // namespace trilens
