// Vertex normals weighted by angle [Thuermer, Wuethrich, Computing Vertex Normals from Polygonal Facets,
// 1998].
#include "scene/meshes/vertex_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vector>

namespace trilens {
namespace {

/// The direction of the polygon's vector area, which no single corner decides; zero where it has none.
Vec3 face_normal(const std::vector<Vec3>& polygon) {
    Vec3 sum(0);
    for (std::size_t k = 1; k + 1 < polygon.size(); ++k)
        sum += cross(polygon[k] - polygon[0], polygon[k + 1] - polygon[0]);
    return normalize_or_zero(sum);
}

/// Of the edges to the neighbours of a corner, in radians; 0 where one has no length.
double corner_angle(const Vec3& before, const Vec3& at, const Vec3& after) {
    const Vec3 a = before - at, b = after - at;
    return std::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace

std::vector<std::size_t> first_at_place(const std::vector<Vec3>& points) {
    std::map<std::array<double, 3>, std::size_t> places;
    std::vector<std::size_t> first(points.size());
    for (std::size_t p = 0; p < points.size(); ++p)
        first[p] = places.try_emplace({points[p].x, points[p].y, points[p].z}, p).first->second;
    return first;
}

std::vector<Vec3> corner_normals(const Cage& cage) {
    std::vector<Vec3> weighted(cage.face_vertex_indices.size(), Vec3(0));
    std::vector<char> is_hole(cage.face_vertex_counts.size(), 0);
    for (const int face : cage.hole_indices) is_hole[static_cast<std::size_t>(face)] = 1;
    std::vector<Vec3> polygon;
    std::size_t first = 0;
    for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face) {
        const auto count = static_cast<std::size_t>(cage.face_vertex_counts[face]);
        const int* const corners = cage.face_vertex_indices.data() + first;
        polygon.clear();
        for (std::size_t k = 0; k < count; ++k)
            polygon.push_back(cage.points[static_cast<std::size_t>(corners[k])]);
        const Vec3 normal = is_hole[face] ? Vec3(0) : face_normal(polygon);
        for (std::size_t k = 0; k < count; ++k)
            weighted[first + k] =
                corner_angle(polygon[(k + count - 1) % count], polygon[k], polygon[(k + 1) % count]) * normal;
        first += count;
    }
    return weighted;
}

void add_smooth_normals(PolygonMesh& mesh) {
    const std::vector<std::size_t> place = first_at_place(mesh.cage.points);
    const std::vector<Vec3> weighted = corner_normals(mesh.cage);
    std::vector<Vec3> sums(mesh.cage.points.size(), Vec3(0));
    for (std::size_t corner = 0; corner < weighted.size(); ++corner)
        sums[place[static_cast<std::size_t>(mesh.cage.face_vertex_indices[corner])]] += weighted[corner];
    mesh.normals.resize(mesh.cage.face_vertex_indices.size(), Vec3(0));
    for (std::size_t corner = 0; corner < mesh.normals.size(); ++corner) {
        if (mesh.normals[corner] != Vec3(0)) continue;
        const Vec3& sum = sums[place[static_cast<std::size_t>(mesh.cage.face_vertex_indices[corner])]];
        if (length(sum) > kCancelled) mesh.normals[corner] = normalize_or_zero(sum);
    }
}

void set_shading(PolygonMesh& mesh, ObjectShading shading) {
    if (shading == ObjectShading::kFlatNormals) {
        mesh.normals.clear();
        mesh.tangents.clear();
    }
    if (shading == ObjectShading::kSmoothNormals) add_smooth_normals(mesh);
}

}  // namespace trilens
