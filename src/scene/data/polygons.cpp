// Placing and triangulating polygons.
#include "scene/data/polygons.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/data/ear_clipping.h"

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

bool place(PolygonMesh& mesh, const Transform& transform) {
    for (Vec3& point : mesh.cage.points) {
        point = map_point(transform, point);
        if (!in_range(point)) return false;
    }
    const Mat3 normals = normal_map(transform);
    for (Vec3& normal : mesh.normals) normal = normalize_or_zero(normals * normalize_or_zero(normal));
    if (mirrors(transform)) {
        reverse_after_first(mesh.cage.face_vertex_indices, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.uvs, mesh.cage.face_vertex_counts);
        reverse_after_first(mesh.normals, mesh.cage.face_vertex_counts);
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

std::size_t count_without_area(const ObjectMesh& mesh) {
    std::size_t count = 0;
    for (const IdTriple& triangle : mesh.triangles) {
        const Vec3 &a = mesh.points[triangle[0]], &b = mesh.points[triangle[1]],
                   &c = mesh.points[triangle[2]];
        const double longest = std::max({length(b - a), length(c - a), length(c - b)});
        if (!(length(cross(b - a, c - a)) > kNoArea * longest * longest)) ++count;
    }
    return count;
}

}  // namespace trilens
