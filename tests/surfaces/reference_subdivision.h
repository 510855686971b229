// Subdivision written a second time, from the papers and without a library: an independent answer for limit
// points.
//
// Catmull and Clark 1978; Loop 1987; creases and corners: DeRose, Kass and Truong 1998, with the fractional
// transitions between rules as OpenSubdiv documents them; limit masks: Halstead, Kass and DeRose 1993.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "base/description/optic_description.h"

namespace trilens_test {

/// A mesh that remembers which cage face and which (u, v) its faces came from.
struct ReferenceMesh {
    struct Face {
        std::vector<int> vertices;
        int cage_face = 0;
        int sub_face = -1;
        std::vector<trilens::Vec2> uv;  // per corner; empty for n-gons that are not yet split
    };
    struct Edge {
        std::vector<int> faces;
        double sharpness = 0;
    };
    using EdgeKey = std::pair<int, int>;
    static EdgeKey key(int a, int b) { return std::minmax(a, b); }

    trilens::SubdivisionScheme scheme{};
    std::vector<trilens::Vec3> points;
    std::vector<double> corner;  // sharpness per vertex
    std::vector<Face> faces;
    std::map<EdgeKey, Edge> edges;
    std::vector<std::vector<int>> vertex_faces,
        vertex_edges;  // per vertex: faces, and the other ends of its edges

    bool loop() const { return scheme == trilens::SubdivisionScheme::kLoop; }
    bool linear() const { return scheme == trilens::SubdivisionScheme::kBilinear; }
    void connect();
};

inline constexpr double kInfinite = 1e9;
inline double sharper(double s) {
    return s >= 10 ? kInfinite : s;
}
inline double weaker(double s) {
    return s >= 10 ? s : std::max(0.0, s - 1);
}

inline void ReferenceMesh::connect() {
    vertex_faces.assign(points.size(), {});
    vertex_edges.assign(points.size(), {});
    corner.resize(points.size(), 0);
    for (auto& [ends, edge] : edges) edge.faces.clear();
    for (int f = 0; f < static_cast<int>(faces.size()); ++f) {
        const std::vector<int>& v = faces[f].vertices;
        for (std::size_t i = 0; i < v.size(); ++i) {
            edges[key(v[i], v[(i + 1) % v.size()])].faces.push_back(f);
            vertex_faces[v[i]].push_back(f);
        }
    }
    for (const auto& [ends, edge] : edges) {
        vertex_edges[ends.first].push_back(ends.second);
        vertex_edges[ends.second].push_back(ends.first);
    }
}

/// Whether the faces around the vertex fall apart into several fans when crossing edges of two faces only.
inline bool has_many_fans(const ReferenceMesh& mesh, int v) {
    std::set<int> reached = {mesh.vertex_faces[v].front()};
    for (bool grown = true; grown;) {
        grown = false;
        for (int other : mesh.vertex_edges[v]) {
            const std::vector<int>& sides = mesh.edges.at(mesh.key(v, other)).faces;
            if (sides.size() != 2) continue;
            for (int k = 0; k < 2; ++k)
                if (reached.count(sides[k]) && reached.insert(sides[1 - k]).second) grown = true;
        }
    }
    return reached.size() < mesh.vertex_faces[v].size();
}

inline ReferenceMesh reference_mesh(const trilens::Cage& cage) {
    using trilens::Vec2;
    ReferenceMesh mesh;
    mesh.scheme = cage.scheme;
    mesh.points = cage.points;
    int next = 0;
    for (int f = 0; f < static_cast<int>(cage.face_vertex_counts.size()); ++f) {
        ReferenceMesh::Face face;
        face.cage_face = f;
        for (int i = 0; i < cage.face_vertex_counts[f]; ++i)
            face.vertices.push_back(cage.face_vertex_indices[next++]);
        if (mesh.loop()) face.uv = {Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)};
        if (!mesh.loop() && face.vertices.size() == 4)
            face.uv = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
        mesh.faces.push_back(face);
    }
    mesh.connect();

    std::size_t vertex = 0, edge = 0;
    const bool per_chain = cage.crease_sharpnesses.size() == cage.crease_lengths.size();
    for (std::size_t chain = 0; chain < cage.crease_lengths.size(); ++chain, ++vertex)
        for (int i = 1; i < cage.crease_lengths[chain]; ++i, ++vertex, ++edge) {
            const auto found =
                mesh.edges.find(mesh.key(cage.crease_indices[vertex], cage.crease_indices[vertex + 1]));
            if (found != mesh.edges.end())
                found->second.sharpness = sharper(cage.crease_sharpnesses[per_chain ? chain : edge]);
        }
    for (std::size_t i = 0; i < cage.corner_indices.size(); ++i)
        mesh.corner[cage.corner_indices[i]] = sharper(cage.corner_sharpnesses[i]);

    // Boundaries and edges of three and more faces are creases; corners of one face and bow ties are corners.
    for (auto& [ends, e] : mesh.edges)
        if (e.faces.size() != 2) e.sharpness = kInfinite;
    for (int v = 0; v < static_cast<int>(mesh.points.size()); ++v) {
        if (mesh.vertex_faces[v].empty()) continue;
        int odd_edges = 0;
        for (int other : mesh.vertex_edges[v])
            odd_edges += mesh.edges.at(mesh.key(v, other)).faces.size() > 2;
        const bool one_face = mesh.vertex_faces[v].size() == 1;
        const bool to_corner = cage.interpolate_boundary == trilens::InterpolateBoundary::kEdgeAndCorner;
        if (one_face && to_corner) mesh.corner[v] = kInfinite;
        if (has_many_fans(mesh, v) && odd_edges != 2) mesh.corner[v] = kInfinite;
    }
    return mesh;
}

struct VertexRule {
    enum Kind { kSmooth, kCrease, kCorner } kind = kSmooth;
    std::vector<int> along;  // crease: the other ends of its two edges
};

inline VertexRule vertex_rule(const ReferenceMesh& mesh, int v, bool child) {
    const auto aged = [child](double s) { return child ? weaker(s) : s; };
    VertexRule rule;
    for (int other : mesh.vertex_edges[v])
        if (aged(mesh.edges.at(mesh.key(v, other)).sharpness) > 0) rule.along.push_back(other);
    if (rule.along.size() == 2) rule.kind = VertexRule::kCrease;
    if (rule.along.size() > 2 || aged(mesh.corner[v]) > 0) rule.kind = VertexRule::kCorner;
    return rule;
}

inline double transition(const ReferenceMesh& mesh, int v) {
    double sum = 0;
    int count = 0;
    const auto add = [&](double s) {
        if (s > 0 && weaker(s) <= 0) sum += s, ++count;
    };
    add(mesh.corner[v]);
    for (int other : mesh.vertex_edges[v]) add(mesh.edges.at(mesh.key(v, other)).sharpness);
    return count == 0 ? 0 : std::min(1.0, sum / count);
}

inline trilens::Vec3 face_point(const ReferenceMesh& mesh, int f) {
    trilens::Vec3 sum(0);
    for (int v : mesh.faces[f].vertices) sum += mesh.points[v];
    return sum / static_cast<double>(mesh.faces[f].vertices.size());
}

inline trilens::Vec3 apply_rule(const ReferenceMesh& mesh, int v, const VertexRule& rule) {
    const trilens::Vec3& p = mesh.points[v];
    if (rule.kind == VertexRule::kCorner || mesh.linear()) return p;
    if (rule.kind == VertexRule::kCrease)
        return 0.75 * p + 0.125 * (mesh.points[rule.along[0]] + mesh.points[rule.along[1]]);
    const double n = static_cast<double>(mesh.vertex_edges[v].size());
    trilens::Vec3 ends(0), faces(0);
    for (int other : mesh.vertex_edges[v]) ends += mesh.points[other];
    if (mesh.loop()) {
        const double c = 0.375 + 0.25 * std::cos(2 * 3.14159265358979323846 / n);
        const double beta = (0.625 - c * c) / n;
        return (1 - n * beta) * p + beta * ends;
    }
    for (int f : mesh.vertex_faces[v]) faces += face_point(mesh, f);
    return (n - 2) / n * p + (ends + faces) / (n * n);
}

inline trilens::Vec3 new_vertex(const ReferenceMesh& mesh, int v) {
    if (mesh.vertex_faces[v].empty()) return mesh.points[v];
    const VertexRule parent = vertex_rule(mesh, v, false), child = vertex_rule(mesh, v, true);
    const trilens::Vec3 sharp = apply_rule(mesh, v, parent);
    if (parent.kind == child.kind) return sharp;
    const double weight = transition(mesh, v);
    return weight * sharp + (1 - weight) * apply_rule(mesh, v, child);
}

inline trilens::Vec3 new_edge(const ReferenceMesh& mesh, const ReferenceMesh::EdgeKey& ends,
                              const ReferenceMesh::Edge& edge) {
    const trilens::Vec3 middle = 0.5 * (mesh.points[ends.first] + mesh.points[ends.second]);
    if (mesh.linear() || edge.sharpness >= 1 || edge.faces.size() != 2) return middle;
    trilens::Vec3 smooth;
    if (mesh.loop()) {
        smooth = 0.75 * middle;
        for (int f : edge.faces)
            for (int v : mesh.faces[f].vertices)
                if (v != ends.first && v != ends.second) smooth += 0.125 * mesh.points[v];
    } else {
        smooth = 0.5 * middle + 0.25 * (face_point(mesh, edge.faces[0]) + face_point(mesh, edge.faces[1]));
    }
    return edge.sharpness * middle + (1 - edge.sharpness) * smooth;
}

inline ReferenceMesh refine(const ReferenceMesh& mesh) {
    using trilens::Vec2;
    ReferenceMesh fine;
    fine.scheme = mesh.scheme;
    for (int v = 0; v < static_cast<int>(mesh.points.size()); ++v) {
        fine.points.push_back(new_vertex(mesh, v));
        fine.corner.push_back(weaker(mesh.corner[v]));
    }
    std::map<ReferenceMesh::EdgeKey, int> middle;
    for (const auto& [ends, edge] : mesh.edges) {
        const int m = static_cast<int>(fine.points.size());
        middle[ends] = m;
        fine.points.push_back(new_edge(mesh, ends, edge));
        for (int end : {ends.first, ends.second})
            fine.edges[mesh.key(end, m)].sharpness = weaker(edge.sharpness);
    }
    for (int f = 0; f < static_cast<int>(mesh.faces.size()); ++f) {
        const ReferenceMesh::Face& face = mesh.faces[f];
        const int n = static_cast<int>(face.vertices.size());
        std::vector<int> m;
        for (int i = 0; i < n; ++i)
            m.push_back(middle.at(mesh.key(face.vertices[i], face.vertices[(i + 1) % n])));
        const auto uv_between = [&](int i) { return 0.5 * (face.uv[i] + face.uv[(i + 1) % n]); };
        if (mesh.loop()) {
            for (int i = 0; i < 3; ++i)
                fine.faces.push_back({{face.vertices[i], m[i], m[(i + 2) % 3]},
                                      face.cage_face,
                                      -1,
                                      {face.uv[i], uv_between(i), uv_between((i + 2) % 3)}});
            fine.faces.push_back({m, face.cage_face, -1, {uv_between(0), uv_between(1), uv_between(2)}});
            continue;
        }
        const int centre = static_cast<int>(fine.points.size());
        fine.points.push_back(face_point(mesh, f));
        for (int i = 0; i < n; ++i) {
            ReferenceMesh::Face child{
                {face.vertices[i], m[i], centre, m[(i + n - 1) % n]}, face.cage_face, face.sub_face, {}};
            if (face.uv.empty()) {
                child.sub_face = i;
                child.uv = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
            } else {
                child.uv = {face.uv[i], uv_between(i), 0.5 * (face.uv[0] + face.uv[2]),
                            uv_between((i + 3) % 4)};
            }
            fine.faces.push_back(child);
        }
    }
    fine.connect();
    return fine;
}

/// The limit of a vertex of a mesh without n-gons; none while semi-sharp features still end or pass there.
inline std::optional<trilens::Vec3> limit_point(const ReferenceMesh& mesh, int v) {
    const auto is_semi = [](double s) { return s > 0 && s < 10; };
    if (is_semi(mesh.corner[v])) return std::nullopt;
    for (int other : mesh.vertex_edges[v])
        if (is_semi(mesh.edges.at(mesh.key(v, other)).sharpness)) return std::nullopt;

    const VertexRule rule = vertex_rule(mesh, v, false);
    const trilens::Vec3& p = mesh.points[v];
    if (rule.kind == VertexRule::kCorner || mesh.linear()) return p;
    if (rule.kind == VertexRule::kCrease)
        return (4.0 * p + mesh.points[rule.along[0]] + mesh.points[rule.along[1]]) / 6.0;
    if (!rule.along.empty()) return std::nullopt;  // a dart has no simple mask
    const double n = static_cast<double>(mesh.vertex_edges[v].size());
    trilens::Vec3 ends(0), faces(0);
    for (int other : mesh.vertex_edges[v]) ends += mesh.points[other];
    if (mesh.loop()) {
        const double c = 0.375 + 0.25 * std::cos(2 * 3.14159265358979323846 / n);
        const double beta = (0.625 - c * c) / n, share = 1 / (3 / (8 * beta) + n);
        return (1 - n * share) * p + share * ends;
    }
    for (int f : mesh.vertex_faces[v])
        for (std::size_t i = 0; i < 4; ++i)
            if (mesh.faces[f].vertices[i] == v) faces += mesh.points[mesh.faces[f].vertices[(i + 2) % 4]];
    return (n * n * p + 4.0 * ends + faces) / (n * (n + 5));
}

}  // namespace trilens_test
