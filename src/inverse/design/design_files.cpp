// A designed mirror or lens as a scene and as the files of those who make it.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/util/format.h"
#include "inverse/design/design.h"
#include "json/json.h"

namespace trilens {
namespace {

constexpr int kSquares = 12;  // across a wished plane
constexpr int kFilmWidth = 640;
constexpr double kPictureMargin = 1.15;  // of the mirror or lens in its eye's picture

Json triple_json(const Vec3& v) {
    return Json::array({v.x, v.y, v.z});
}

/// The squares of one colour of a wished plane, a little beyond it.
Json squares_json(const WishMap& wish, int colour) {
    Json points = Json::array(), counts = Json::array(), indices = Json::array();
    constexpr int kBeyond = 2;
    for (int row = -kBeyond; row < kSquares + kBeyond; ++row)
        for (int column = -kBeyond; column < kSquares + kBeyond; ++column) {
            if ((row + column + 2 * kBeyond) % 2 != colour) continue;
            for (const auto& [i, j] : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)}) {
                indices.push_back(points.size());
                points.push_back(triple_json(wish.origin +
                                             (static_cast<double>(column + i) / kSquares) * wish.u +
                                             (static_cast<double>(row + j) / kSquares) * wish.v));
            }
            counts.push_back(4);
        }
    return {{"name", colour == 0 ? "light squares" : "dark squares"},
            {"role", "object"},
            {"material", colour == 0 ? "light" : "dark"},
            {"points", points},
            {"faceVertexCounts", counts},
            {"faceVertexIndices", indices}};
}

Json camera_json(const DesignWish& wish) {
    const PatchFrame frame(wish.patch);
    const Vec3 look = normalize(wish.patch.center - wish.eye);
    const Vec3 up = frame.world_from_patch[1];
    // Half the angle that holds the rectangle's corners, over the film's height.
    const Vec3 right = normalize(cross(look, up)), above = cross(right, look);
    double high = 0;
    for (const double s : {-0.5, 0.5})
        for (const double t : {-0.5, 0.5}) {
            const Vec3 corner = frame.to_world({s * wish.patch.size.x, t * wish.patch.size.y, 0}) - wish.eye;
            high = std::max(high, std::abs(dot(corner, above)) / dot(corner, look));
        }
    const double yfov = 2 * std::atan(kPictureMargin * high) * 57.29577951308232;
    return {
        {"name", "eye"},
        {"type", "perspective"},
        {"yfov", std::min(yfov, 170.0)},
        {"lookAt",
         {{"eye", triple_json(wish.eye)}, {"at", triple_json(wish.patch.center)}, {"up", triple_json(up)}}}};
}

struct MadePoint {
    Vec3 place{0}, normal{0};
};

/// steps + 1 points along both sides, row by row.
std::vector<MadePoint> made_points(const HeightField& surface, int steps) {
    std::vector<MadePoint> points;
    for (int row = 0; row <= steps; ++row)
        for (int column = 0; column <= steps; ++column) {
            const Vec2 at = (Vec2(column, row) / static_cast<double>(steps) - 0.5) * surface.size;
            const Height h = surface.height(at);
            points.push_back({Vec3(at, h.z), normalize(Vec3(-h.x, -h.y, 1))});
        }
    return points;
}

class StlBytes {
  public:
    explicit StlBytes(const std::string& title) : bytes_(84, '\0') {
        std::memcpy(bytes_.data(), title.data(), std::min<std::size_t>(title.size(), 80));
    }
    void add(const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 normal = normalize_or_zero(cross(b - a, c - a));
        for (const Vec3& v : {normal, a, b, c})
            for (int k = 0; k < 3; ++k) add_word(std::bit_cast<std::uint32_t>(static_cast<float>(v[k])));
        bytes_.append(2, '\0');
        ++count_;
    }
    std::string finish() {
        for (int k = 0; k < 4; ++k)
            bytes_[80 + static_cast<std::size_t>(k)] = static_cast<char>(count_ >> (8 * k) & 255);
        return std::move(bytes_);
    }

  private:
    void add_word(std::uint32_t word) {
        for (int k = 0; k < 4; ++k) bytes_ += static_cast<char>(word >> (8 * k) & 255);
    }
    std::string bytes_;
    std::uint32_t count_ = 0;
};

}  // namespace

Cage design_cage(const DesignWish& wish, const Design& design) {
    const PatchFrame frame(wish.patch);
    const HeightField& field = design.surface;
    Cage cage;
    cage.interpolate_boundary = InterpolateBoundary::kNothing;
    const int columns = field.controls[0], rows = field.controls[1];
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column)
            cage.points.push_back(
                frame.to_world(Vec3(field.control_place(column, row),
                                    field.heights[static_cast<std::size_t>(row * columns + column)])));
    for (int row = 0; row + 1 < rows; ++row)
        for (int column = 0; column + 1 < columns; ++column) {
            const int corner = row * columns + column;
            cage.face_vertex_counts.push_back(4);
            for (const int index : {corner, corner + 1, corner + columns + 1, corner + columns})
                cage.face_vertex_indices.push_back(index);
            // The rim only bends its neighbours: it has no surface of its own.
            if (row == 0 || column == 0 || row + 2 == rows || column + 2 == columns)
                cage.hole_indices.push_back(static_cast<int>(cage.face_vertex_counts.size()) - 1);
        }
    return cage;
}

namespace {

Json mirror_json(const DesignWish& wish, const Design& design) {
    const Cage cage = design_cage(wish, design);
    Json points = Json::array();
    for (const Vec3& point : cage.points) points.push_back(triple_json(point));
    return {{"name", "mirror"},
            {"role", "optic"},
            {"material", "mirror"},
            {"subdivisionScheme", "catmullClark"},
            {"interpolateBoundary", "none"},
            {"points", points},
            {"faceVertexCounts", cage.face_vertex_counts},
            {"faceVertexIndices", cage.face_vertex_indices},
            {"holeIndices", cage.hole_indices}};
}

/// Rows of control points of a uniform bicubic B-spline, in the rectangle's frame.
using ControlRows = std::vector<std::vector<Vec3>>;

/// The curve in which such a surface ends: the row beside which it has one more, weighted as cubics are
/// there.
std::vector<Vec3> end_curve(const ControlRows& rows) {
    std::vector<Vec3> curve;
    for (std::size_t k = 0; k < rows[0].size(); ++k)
        curve.push_back((rows[0][k] + 4.0 * rows[1][k] + rows[2][k]) / 6.0);
    return curve;
}

/// A wall straight from one curve to another.
ControlRows straight_wall(const std::vector<Vec3>& top, const std::vector<Vec3>& bottom) {
    ControlRows rows(4, top);
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t k = 0; k < top.size(); ++k)
            rows[row][k] = top[k] + (static_cast<double>(row) - 1) * (bottom[k] - top[k]);
    return rows;
}

ControlRows transposed(const ControlRows& rows) {
    ControlRows turned(rows[0].size());
    for (const std::vector<Vec3>& row : rows)
        for (std::size_t k = 0; k < row.size(); ++k) turned[k].push_back(row[k]);
    return turned;
}

ControlRows reversed(ControlRows rows) {
    std::reverse(rows.begin(), rows.end());
    return rows;
}

Json spline_json(const PatchFrame& frame, const ControlRows& rows) {
    Json points = Json::array();
    for (const std::vector<Vec3>& row : rows)
        for (const Vec3& point : row) points.push_back(triple_json(frame.to_world(point)));
    return {{"type", "bspline"}, {"columns", rows[0].size()}, {"points", points}};
}

/// A closed body: front, back, and four walls between the curves in which these end, all facing outward.
Json lens_json(const DesignWish& wish, const Design& design) {
    const HeightField& field = design.surface;
    ControlRows front(static_cast<std::size_t>(field.controls[1])), back;
    for (int row = 0; row < field.controls[1]; ++row)
        for (int column = 0; column < field.controls[0]; ++column)
            front[static_cast<std::size_t>(row)].emplace_back(
                field.control_place(column, row),
                field.heights[static_cast<std::size_t>(row * field.controls[0] + column)]);
    back = front;
    for (std::vector<Vec3>& row : back)
        for (Vec3& point : row) point.z = *design.back;
    const PatchFrame frame(wish.patch);
    Json patches = Json::array({spline_json(frame, front), spline_json(frame, reversed(back))});
    // Seen from outside, with u along the end of the front: below, above, left and right of the rectangle.
    const ControlRows across = transposed(front), across_back = transposed(back);
    patches.push_back(spline_json(frame, reversed(straight_wall(end_curve(front), end_curve(back)))));
    patches.push_back(
        spline_json(frame, straight_wall(end_curve(reversed(front)), end_curve(reversed(back)))));
    patches.push_back(spline_json(frame, straight_wall(end_curve(across), end_curve(across_back))));
    patches.push_back(spline_json(
        frame, reversed(straight_wall(end_curve(reversed(across)), end_curve(reversed(across_back))))));
    return {
        {"name", "lens"}, {"role", "optic"}, {"material", "glass"}, {"resolution", 4}, {"patches", patches}};
}

}  // namespace

std::string design_scene(const DesignWish& wish, const Design& design) {
    Json scene{{"version", 1}};
    const double aspect = wish.patch.size.y / wish.patch.size.x;
    scene["film"] = {
        {"width", kFilmWidth},
        {"height", std::clamp(static_cast<int>(std::lround(kFilmWidth * aspect)), 16, 4 * kFilmWidth)},
        {"spp", 3}};
    scene["cameras"] = Json::array({camera_json(wish)});
    scene["background"] = {{"color", {0.55, 0.65, 0.8}}};
    scene["materials"] =
        Json::array({wish.lens ? Json{{"name", "glass"}, {"transmissionFactor", 1}, {"ior", wish.lens->ior}}
                               : Json{{"name", "mirror"}, {"metallicFactor", 1}, {"roughnessFactor", 0}}});
    scene["meshes"] = Json::array({wish.lens ? lens_json(wish, design) : mirror_json(wish, design)});
    if (wish.wish.type == WishType::kPlane) {
        scene["materials"].push_back(
            {{"name", "light"}, {"baseColorFactor", {0.9, 0.88, 0.8}}, {"unlit", true}});
        scene["materials"].push_back(
            {{"name", "dark"}, {"baseColorFactor", {0.12, 0.2, 0.35}}, {"unlit", true}});
        scene["meshes"].push_back(squares_json(wish.wish, 0));
        scene["meshes"].push_back(squares_json(wish.wish, 1));
    }
    return scene.dump(1) + "\n";
}

std::string design_stl(const Design& design, double thickness, int steps) {
    const std::vector<MadePoint> front = made_points(design.surface, steps);
    double lowest = std::numeric_limits<double>::infinity();
    for (const MadePoint& point : front) lowest = std::min(lowest, point.place.z);
    const double back = design.back.value_or(lowest - thickness);
    const auto at = [&](int column, int row) {
        return front[static_cast<std::size_t>(row * (steps + 1) + column)].place;
    };
    const auto behind = [&](int column, int row) { return Vec3(Vec2(at(column, row)), back); };
    StlBytes stl(std::string("trilens ") + (design.back ? "lens" : "mirror") + ", closed body");
    const auto add_square = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
        stl.add(a, b, c);
        stl.add(a, c, d);
    };
    for (int row = 0; row < steps; ++row)
        for (int column = 0; column < steps; ++column) {
            add_square(at(column, row), at(column + 1, row), at(column + 1, row + 1), at(column, row + 1));
            add_square(behind(column, row), behind(column, row + 1), behind(column + 1, row + 1),
                       behind(column + 1, row));
        }
    for (int k = 0; k < steps; ++k) {
        add_square(at(k, 0), behind(k, 0), behind(k + 1, 0), at(k + 1, 0));
        add_square(at(k + 1, steps), behind(k + 1, steps), behind(k, steps), at(k, steps));
        add_square(at(0, k + 1), behind(0, k + 1), behind(0, k), at(0, k));
        add_square(at(steps, k), behind(steps, k), behind(steps, k + 1), at(steps, k + 1));
    }
    return stl.finish();
}

std::string design_obj(const Design& design, int steps) {
    const std::string what = design.back ? "lens" : "mirror";
    std::string text = "# trilens " + what + ": x along the tangent, z along the normal\no " + what + "\n";
    const std::vector<MadePoint> points = made_points(design.surface, steps);
    for (const MadePoint& p : points)
        text += fmt::format("v {:.12g} {:.12g} {:.12g}\n", p.place.x, p.place.y, p.place.z);
    for (const MadePoint& p : points)
        text += fmt::format("vn {:.9g} {:.9g} {:.9g}\n", p.normal.x, p.normal.y, p.normal.z);
    for (int row = 0; row < steps; ++row)
        for (int column = 0; column < steps; ++column) {
            const int a = row * (steps + 1) + column + 1, d = a + steps + 1;
            text += fmt::format("f {0}//{0} {1}//{1} {2}//{2} {3}//{3}\n", a, a + 1, d + 1, d);
        }
    return text;
}

std::string design_sag_table(const Design& design, int steps) {
    std::string text = "x,y,z,nx,ny,nz\n";
    for (const MadePoint& p : made_points(design.surface, steps))
        text += fmt::format("{:.12g},{:.12g},{:.12g},{:.9g},{:.9g},{:.9g}\n", p.place.x, p.place.y, p.place.z,
                            p.normal.x, p.normal.y, p.normal.z);
    return text;
}

}  // namespace trilens
