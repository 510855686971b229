#include "scene/meshes/weld.h"

#include <array>
#include <map>
#include <utility>

namespace trilens {
namespace {

/// Faces taken over one by one, with what goes with their corners.
class FaceCopier {
  public:
    explicit FaceCopier(const PolygonMesh& from) : from_(from) {
        to_.cage = from.cage;
        to_.materials = from.materials;
        to_.heights = from.heights;
        to_.is_triangle_soup = from.is_triangle_soup;
        to_.cage.face_vertex_counts.clear();
        to_.cage.face_vertex_indices.clear();
        to_.cage.hole_indices.clear();
    }

    /// `corners`: places in the old face_vertex_indices.
    void add(std::span<const std::size_t> corners, std::size_t face) {
        to_.cage.face_vertex_counts.push_back(static_cast<int>(corners.size()));
        if (!from_.face_material.empty()) to_.face_material.push_back(from_.face_material[face]);
        for (const std::size_t corner : corners) {
            to_.cage.face_vertex_indices.push_back(from_.cage.face_vertex_indices[corner]);
            if (!from_.uvs.empty()) to_.uvs.push_back(from_.uvs[corner]);
            if (!from_.second_uvs.empty()) to_.second_uvs.push_back(from_.second_uvs[corner]);
            if (!from_.colors.empty()) to_.colors.push_back(from_.colors[corner]);
            if (!from_.normals.empty()) to_.normals.push_back(from_.normals[corner]);
            if (!from_.tangents.empty()) to_.tangents.push_back(from_.tangents[corner]);
        }
    }

    PolygonMesh done() { return std::move(to_); }

  private:
    const PolygonMesh& from_;
    PolygonMesh to_;
};

Vec3 normal_of(const PolygonMesh& mesh, std::size_t first) {
    const auto point = [&](std::size_t k) {
        return mesh.cage.points[static_cast<std::size_t>(mesh.cage.face_vertex_indices[first + k])];
    };
    return normalize_or_zero(cross(point(1) - point(0), point(2) - point(0)));
}

/// The corners of the quad of two triangles, the first of which begin at `a` and `b`; empty where they share
/// no edge that they run along in opposite directions.
std::vector<std::size_t> quad_of(const PolygonMesh& mesh, std::size_t a, std::size_t b) {
    const std::vector<int>& index = mesh.cage.face_vertex_indices;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t i1 = (i + 1) % 3, j1 = (j + 1) % 3;
            if (index[a + i] != index[b + j1] || index[a + i1] != index[b + j]) continue;
            // a: (i, i1, apex); b comes in between i and i1.
            return {a + i, b + (j + 2) % 3, a + i1, a + (i + 2) % 3};
        }
    return {};
}

}  // namespace

void weld_points(PolygonMesh& mesh) {
    std::map<std::array<double, 3>, int> place;
    std::vector<int> now(mesh.cage.points.size());
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < mesh.cage.points.size(); ++i) {
        const Vec3 p = mesh.cage.points[i] + Vec3(0.0);  // -0 becomes 0
        const auto [found, is_new] = place.try_emplace({p.x, p.y, p.z}, static_cast<int>(points.size()));
        if (is_new) points.push_back(p);
        now[i] = found->second;
    }
    mesh.cage.points = std::move(points);
    for (int& index : mesh.cage.face_vertex_indices) index = now[static_cast<std::size_t>(index)];
    FaceCopier copier(mesh);
    std::size_t first = 0;
    for (std::size_t face = 0; face < mesh.cage.face_vertex_counts.size(); ++face) {
        const auto count = static_cast<std::size_t>(mesh.cage.face_vertex_counts[face]);
        std::vector<std::size_t> corners;
        bool whole = true;
        for (std::size_t k = 0; k < count; ++k) {
            corners.push_back(first + k);
            whole = whole && mesh.cage.face_vertex_indices[first + k] !=
                                 mesh.cage.face_vertex_indices[first + (k + 1) % count];
        }
        if (whole) copier.add(corners, face);
        first += count;
    }
    mesh = copier.done();
}

void join_quads(PolygonMesh& mesh) {
    const std::vector<int>& counts = mesh.cage.face_vertex_counts;
    FaceCopier copier(mesh);
    std::size_t first = 0;
    for (std::size_t face = 0; face < counts.size(); ++face) {
        const auto count = static_cast<std::size_t>(counts[face]);
        std::vector<std::size_t> corners;
        if (count == 3 && face + 1 < counts.size() && counts[face + 1] == 3 &&
            dot(normal_of(mesh, first), normal_of(mesh, first + 3)) >= kNearlyFlat)
            corners = quad_of(mesh, first, first + 3);
        if (!corners.empty()) {
            copier.add(corners, face);
            first += 6;
            ++face;
            continue;
        }
        for (std::size_t k = 0; k < count; ++k) corners.push_back(first + k);
        copier.add(corners, face);
        first += count;
    }
    mesh = copier.done();
}

std::size_t cut_into_triangles(PolygonMesh& mesh) {
    std::vector<char> is_hole(mesh.cage.face_vertex_counts.size(), 0);
    for (const int face : mesh.cage.hole_indices) is_hole[static_cast<std::size_t>(face)] = 1;
    FaceCopier copier(mesh);
    std::size_t first = 0, uncovered = 0;
    std::vector<Vec3> polygon;
    for (std::size_t face = 0; face < mesh.cage.face_vertex_counts.size(); ++face) {
        const auto count = static_cast<std::size_t>(mesh.cage.face_vertex_counts[face]);
        polygon.clear();
        for (std::size_t k = 0; k < count; ++k)
            polygon.push_back(
                mesh.cage.points[static_cast<std::size_t>(mesh.cage.face_vertex_indices[first + k])]);
        if (!is_hole[face]) {
            const PolygonTriangles cut = triangulate_polygon(polygon);
            for (const auto& [a, b, c] : cut.triangles)
                copier.add(std::array<std::size_t, 3>{first + a, first + b, first + c}, face);
            if (!cut.covers) ++uncovered;
        }
        first += count;
    }
    mesh = copier.done();
    return uncovered;
}

}  // namespace trilens
