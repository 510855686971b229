// Placing and triangulating polygons.
#include "scene/data/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <numeric>

namespace trilens {
namespace {

bool in_range(const Vec3& p) {
    // Written so that NaN is out of range.
    return std::abs(p.x) <= kLargestCoordinate && std::abs(p.y) <= kLargestCoordinate &&
           std::abs(p.z) <= kLargestCoordinate;
}

template <class Corner>
void reverse_after_first(std::vector<Corner>& corners, const std::vector<int>& counts) {
    if (corners.empty()) return;
    auto first = corners.begin();
    for (const int count : counts) {
        std::reverse(first + 1, first + count);
        first += count;
    }
}

/// Unit; +Y for a triangle without area, which nothing sees.
Vec3 triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 normal = normalize_or_zero(cross(b - a, c - a));
    return normal == Vec3(0) ? Vec3(0, 1, 0) : normal;
}

std::vector<char> hole_flags(const Cage& cage) {
    std::vector<char> is_hole(cage.face_vertex_counts.size(), 0);
    for (const int face : cage.hole_indices) is_hole[static_cast<std::size_t>(face)] = 1;
    return is_hole;
}

void add_triangle(const PolygonMesh& mesh, const std::array<std::size_t, 3>& corner, ObjectMesh& object) {
    IdTriple points;
    for (std::size_t k = 0; k < 3; ++k) points[k] = static_cast<Id>(mesh.cage.face_vertex_indices[corner[k]]);
    object.triangles.push_back(points);
    if (!mesh.uvs.empty())
        object.uvs.push_back({mesh.uvs[corner[0]], mesh.uvs[corner[1]], mesh.uvs[corner[2]]});
    if (!mesh.second_uvs.empty())
        object.second_uvs.push_back(
            {mesh.second_uvs[corner[0]], mesh.second_uvs[corner[1]], mesh.second_uvs[corner[2]]});
    if (!mesh.colors.empty())
        object.colors.push_back({mesh.colors[corner[0]], mesh.colors[corner[1]], mesh.colors[corner[2]]});
    if (!mesh.tangents.empty())
        object.tangents.push_back(
            {mesh.tangents[corner[0]], mesh.tangents[corner[1]], mesh.tangents[corner[2]]});
    if (mesh.normals.empty()) return;
    std::array<Vec3, 3> normals;
    for (std::size_t k = 0; k < 3; ++k) {
        normals[k] = normalize_or_zero(mesh.normals[corner[k]]);
        if (normals[k] == Vec3(0))
            normals[k] =
                triangle_normal(object.points[points[0]], object.points[points[1]], object.points[points[2]]);
    }
    object.normals.push_back(normals);
}

}  // namespace

bool place(std::vector<Vec3>& points, const Transform& transform) {
    for (Vec3& point : points) {
        point = map_point(transform, point);
        if (!in_range(point)) return false;
    }
    return true;
}

bool place(PolygonMesh& mesh, const Transform& transform) {
    if (!place(mesh.cage.points, transform)) return false;
    const Mat3 normals = normal_map(transform);
    for (Vec3& normal : mesh.normals) normal = normalize_or_zero(normals * normalize_or_zero(normal));
    for (Vec4& tangent : mesh.tangents) tangent = map_tangent(transform, tangent);
    if (mirrors(transform)) {
        reverse_after_first(mesh.cage.face_vertex_indices, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.uvs, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.second_uvs, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.colors, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.normals, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.tangents, mesh.cage.face_vertex_counts);
    }
    return true;
}

TriangulatedMesh triangulate(const PolygonMesh& mesh) {
    TriangulatedMesh result;
    ObjectMesh& object = result.object;
    object.points = mesh.cage.points;
    std::vector<Vec3> polygon;
    const std::vector<char> is_hole = hole_flags(mesh.cage);
    std::size_t first = 0;
    for (std::size_t face = 0; face < mesh.cage.face_vertex_counts.size(); ++face) {
        const auto corners = static_cast<std::size_t>(mesh.cage.face_vertex_counts[face]);
        if (!is_hole[face]) {
            polygon.clear();
            for (std::size_t k = 0; k < corners; ++k)
                polygon.push_back(
                    mesh.cage.points[static_cast<std::size_t>(mesh.cage.face_vertex_indices[first + k])]);
            const PolygonTriangles cut = triangulate_polygon(polygon);
            for (const auto& [a, b, c] : cut.triangles) {
                add_triangle(mesh, {first + a, first + b, first + c}, object);
                object.material.push_back(mesh.face_material.empty() ? kNone : mesh.face_material[face]);
            }
            if (!cut.covers) ++result.uncovered_faces;
        }
        first += corners;
    }
    return result;
}

bool lacks_area(const std::vector<Vec3>& points, const IdTriple& triangle) {
    const Vec3 &a = points[triangle[0]], &b = points[triangle[1]], &c = points[triangle[2]];
    const double longest = std::max({length(b - a), length(c - a), length(c - b)});
    return !(length(cross(b - a, c - a)) > kNoArea * longest * longest);
}

std::size_t count_without_area(const ObjectMesh& mesh) {
    return static_cast<std::size_t>(
        std::count_if(mesh.triangles.begin(), mesh.triangles.end(),
                      [&](const IdTriple& triangle) { return lacks_area(mesh.points, triangle); }));
}

// The winding number law: triangles between the corners whose oriented boundaries sum to the polygon's cover
// each point as often as the polygon winds about it, if all have its orientation. So a cut into triangles of
// positive area is right, whatever way it was found.

namespace {

constexpr double kGrid = 1 << 29;  // half the extent, in steps: twice an area stays below 2^61

// Twice the area by which a flat corner may turn the wrong way once its points lie on the grid: half a step
// each over differences of up to 2^30.
constexpr std::int64_t kFlatArea = (std::int64_t{1} << 32) + 2;

struct GridPoint {
    std::int64_t x = 0, y = 0;
    bool operator==(const GridPoint& other) const { return x == other.x && y == other.y; }
};

/// Twice the signed area, exact.
std::int64_t area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Scaled to extent 1 about corner 0, so that no product overflows.
std::vector<Vec3> scaled(std::span<const Vec3> corners) {
    double extent = 0;
    for (const Vec3& corner : corners)
        for (int k = 0; k < 3; ++k) extent = std::max(extent, std::fabs(corner[k] - corners[0][k]));
    std::vector<Vec3> result;
    for (const Vec3& corner : corners)
        result.push_back(extent > 0 ? (corner - corners[0]) / extent : Vec3(0));
    return result;
}

/// Newell's normal, not unit: twice the polygon's area along each axis. Based on: Sutherland, Sproull,
/// Schumacker, A Characterization of Ten Hidden-Surface Algorithms (1974).
Vec3 newell_normal(const std::vector<Vec3>& corners) {
    Vec3 sum(0);
    for (std::size_t k = 0; k < corners.size(); ++k)
        sum += cross(corners[k], corners[(k + 1) % corners.size()]);
    return sum;
}

std::vector<GridPoint> project(const std::vector<Vec3>& corners, const Vec3& normal) {
    const Vec3 w = normalize_or_zero(normal);
    const Vec3 axis = std::fabs(w.x) <= 0.75 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
    const Vec3 u = normalize(axis - dot(axis, w) * w), v = cross(w, u);
    Vec2 low(dot(corners[0], u), dot(corners[0], v)), high = low;
    for (const Vec3& corner : corners) {
        const Vec2 seen(dot(corner, u), dot(corner, v));
        low = glm::min(low, seen), high = glm::max(high, seen);
    }
    const Vec2 middle = 0.5 * (low + high);
    const double steps = kGrid / (0.5 * std::max(high.x - low.x, high.y - low.y));
    std::vector<GridPoint> result;
    for (const Vec3& corner : corners)
        result.push_back({std::llround((dot(corner, u) - middle.x) * steps),
                          std::llround((dot(corner, v) - middle.y) * steps)});
    return result;
}

bool fan_covers(const std::vector<GridPoint>& p) {
    for (std::size_t k = 1; k + 1 < p.size(); ++k)
        if (area(p[0], p[k], p[k + 1]) < -kFlatArea) return false;
    return true;
}

/// Whether the corner turns the polygon's way, and no other corner lies in its triangle or on its border.
bool is_ear(const std::vector<GridPoint>& p, const std::vector<std::size_t>& left, std::size_t k) {
    const GridPoint &a = p[left[(k + left.size() - 1) % left.size()]], &b = p[left[k]],
                    &c = p[left[(k + 1) % left.size()]];
    if (area(a, b, c) <= 0) return false;
    return std::none_of(left.begin(), left.end(), [&](std::size_t other) {
        const GridPoint& q = p[other];
        if (q == a || q == b || q == c) return false;
        return area(a, b, q) >= 0 && area(b, c, q) >= 0 && area(c, a, q) >= 0;
    });
}

/// Empty where it comes to an end without ears.
std::vector<std::array<std::size_t, 3>> clip_ears(const std::vector<GridPoint>& p) {
    std::vector<std::array<std::size_t, 3>> triangles;
    std::vector<std::size_t> left(p.size());
    std::iota(left.begin(), left.end(), std::size_t{0});
    while (left.size() >= 3) {
        std::size_t k = 0;
        while (k < left.size() && !is_ear(p, left, k)) ++k;
        if (k == left.size()) return {};
        triangles.push_back(
            {left[(k + left.size() - 1) % left.size()], left[k], left[(k + 1) % left.size()]});
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
    }
    return triangles;
}

/// Whether all corners lie on one line, so that there is nothing to cover.
bool is_flat(const std::vector<Vec3>& corners) {
    constexpr double kNoHeight = 1e-14;
    const auto farthest = std::max_element(
        corners.begin(), corners.end(), [](const Vec3& a, const Vec3& b) { return length(a) < length(b); });
    return std::all_of(corners.begin(), corners.end(),
                       [&](const Vec3& corner) { return length(cross(corner, *farthest)) <= kNoHeight; });
}

}  // namespace

PolygonTriangles triangulate_polygon(std::span<const Vec3> corners) {
    PolygonTriangles result;
    for (std::size_t k = 1; k + 1 < corners.size(); ++k) result.triangles.push_back({0, k, k + 1});
    if (corners.size() < 4) return result;

    constexpr double kNoPlane = 1e-14;  // of the extent squared
    const std::vector<Vec3> unit = scaled(corners);
    const Vec3 normal = newell_normal(unit);
    if (!(length(normal) > kNoPlane)) {
        result.covers = is_flat(unit);
        return result;
    }
    const std::vector<GridPoint> seen = project(unit, normal);
    if (fan_covers(seen)) return result;
    std::vector<std::array<std::size_t, 3>> ears = clip_ears(seen);
    result.covers = !ears.empty();
    if (result.covers) result.triangles = std::move(ears);
    return result;
}

// The arithmetic of affine maps.

Transform compose(const Transform& outer, const Transform& inner) {
    return {outer.linear * inner.linear, map_point(outer, inner.translation)};
}

Transform make_transform(const Vec3& translate, const Vec4& rotate, const Vec3& scale) {
    const double largest =
        std::max({std::abs(rotate.x), std::abs(rotate.y), std::abs(rotate.z), std::abs(rotate.w)});
    const Vec4 unit = glm::normalize(rotate / largest);
    const Mat3 rotation = glm::mat3_cast(Quat(unit.w, unit.x, unit.y, unit.z));
    return {Mat3(rotation[0] * scale.x, rotation[1] * scale.y, rotation[2] * scale.z), translate};
}

Vec4 quaternion_about(const Vec3& axis, double degrees) {
    const double half = std::remainder(degrees, 720) * std::numbers::pi / 360;
    return {std::sin(half) * normalize_or_zero(axis), std::cos(half)};
}

Vec4 quaternion_of_euler(const Vec3& degrees, const std::string& order) {
    Quat all(1, 0, 0, 0);
    for (const char letter : order) {
        const int k = letter - 'X';
        Vec3 axis(0);
        axis[k] = 1;
        const Vec4 one = quaternion_about(axis, degrees[k]);
        all = Quat(one.w, one.x, one.y, one.z) * all;
    }
    return {all.x, all.y, all.z, all.w};
}

std::optional<Transform> make_transform(std::span<const double, 16> columns) {
    if (columns[3] != 0 || columns[7] != 0 || columns[11] != 0 || columns[15] != 1) return std::nullopt;
    Transform t;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            t.linear[column][row] = columns[static_cast<std::size_t>(4 * column + row)];
    t.translation = {columns[12], columns[13], columns[14]};
    return t;
}

bool flattens(const Transform& t) {
    // Unit columns first, so that tiny and huge scales count for nothing.
    const Mat3 unit(normalize_or_zero(t.linear[0]), normalize_or_zero(t.linear[1]),
                    normalize_or_zero(t.linear[2]));
    return !(std::abs(glm::determinant(unit)) > kFlat);
}

bool mirrors(const Transform& t) {
    return triple(normalize_or_zero(t.linear[0]), normalize_or_zero(t.linear[1]),
                  normalize_or_zero(t.linear[2])) < 0;
}

Mat3 normal_map(const Transform& t) {
    // The cofactor matrix is the inverse transpose times the determinant, of which only the sign matters.
    const Mat3& m = t.linear;
    const double sign = mirrors(t) ? -1 : 1;
    return {sign * cross(m[1], m[2]), sign * cross(m[2], m[0]), sign * cross(m[0], m[1])};
}

Vec4 map_tangent(const Transform& t, const Vec4& tangent) {
    const Vec3 turned = normalize_or_zero(t.linear * normalize_or_zero(Vec3(tangent)));
    return {turned, mirrors(t) ? -tangent.w : tangent.w};
}

std::optional<double> similarity_factor(const Transform& t) {
    const double factor = length(t.linear[0]);
    for (int i = 0; i < 3; ++i) {
        const Vec3 column = t.linear[i] / factor, next = t.linear[(i + 1) % 3] / factor;
        if (!(std::abs(dot(column, column) - 1) <= kSimilar) || !(std::abs(dot(column, next)) <= kSimilar))
            return std::nullopt;
    }
    return factor;
}

}  // namespace trilens
