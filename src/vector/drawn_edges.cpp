// Which edges of a triangle scene a line drawing shows.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <tuple>

#include "vector/drawing.h"

namespace trilens {
namespace {

/// Two triangles of one flat face: their unit normals differ by rounding alone.
constexpr double kFlat = 1e-9;

/// One id per object and place.
std::vector<std::array<Id, 3>> weld(const TriangleScene& scene, std::size_t& count) {
    std::map<std::tuple<Id, double, double, double>, Id> places;
    std::vector<std::array<Id, 3>> vertices(scene.size());
    for (std::size_t f = 0; f < scene.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& p = scene.points[scene.triangles[f][k]];
            const auto key = std::make_tuple(scene.object[f], p.x + 0.0, p.y + 0.0, p.z + 0.0);
            vertices[f][k] = places.try_emplace(key, static_cast<Id>(places.size())).first->second;
        }
    count = places.size();
    return vertices;
}

/// One triangle's use of an edge, sorted so that the users of an edge stand together.
struct Use {
    Id low, high, triangle, edge;
    bool forward;  // the edge runs from low to high
    auto key() const { return std::make_tuple(low, high, triangle, edge); }
};

std::vector<Use> sorted_uses(const std::vector<std::array<Id, 3>>& vertices) {
    std::vector<Use> uses;
    for (Id f = 0; f < vertices.size(); ++f)
        for (Id e = 0; e < 3; ++e) {
            const Id a = vertices[f][e], b = vertices[f][(e + 1) % 3];
            if (a != b) uses.push_back({std::min(a, b), std::max(a, b), f, e, a < b});
        }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.key() < b.key(); });
    return uses;
}

/// The edge between two triangles; false where it is never drawn.
bool describe_pair(const DrawnEdges& edges, const EdgeRules& rules, DrawnEdge& edge) {
    const Vec3 n = normalize_or_zero(edges.normal[edge.triangle]),
               m = normalize_or_zero(edges.normal[edge.other]);
    const double cosine = dot(n, m) * (edge.same_winding ? 1.0 : -1.0);
    const bool materials = rules.material[edge.triangle] != rules.material[edge.other];
    const bool creased =
        edge.triangle < rules.without_creases && cosine < std::cos(kCreaseAngle * std::numbers::pi / 180);
    edge.always = materials || creased;
    return edge.always || length(n - m * (edge.same_winding ? 1.0 : -1.0)) > kFlat;
}

void index_by_vertex(DrawnEdges& edges, std::size_t vertex_count) {
    edges.first_of.assign(vertex_count + 1, 0);
    const auto each_end = [&](auto body) {
        for (Id i = 0; i < edges.edge.size(); ++i) {
            const DrawnEdge& e = edges.edge[i];
            body(edges.vertex_of[e.triangle][e.edge], i);
            body(edges.vertex_of[e.triangle][(e.edge + 1) % 3], i);
        }
    };
    each_end([&](Id vertex, Id) { ++edges.first_of[vertex + 1]; });
    std::partial_sum(edges.first_of.begin(), edges.first_of.end(), edges.first_of.begin());
    std::vector<std::size_t> next(edges.first_of.begin(), edges.first_of.end() - 1);
    edges.of_vertex.resize(edges.first_of.back());
    each_end([&](Id vertex, Id i) { edges.of_vertex[next[vertex]++] = i; });
}

}  // namespace

DrawnEdges drawn_edges(const TriangleScene& scene, const EdgeRules& rules) {
    DrawnEdges edges;
    std::size_t vertex_count = 0;
    edges.vertex_of = weld(scene, vertex_count);
    for (const IdTriple& c : scene.triangles)
        edges.normal.push_back(
            cross(scene.points[c[1]] - scene.points[c[0]], scene.points[c[2]] - scene.points[c[0]]));
    edges.neighbour.assign(scene.size(), {kNone, kNone, kNone});
    const std::vector<Use> uses = sorted_uses(edges.vertex_of);
    for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
        while (end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high) ++end;
        DrawnEdge edge{uses[i].triangle, uses[i].edge, kNone, true, true};
        if (end - i == 2) {
            edge.other = uses[i + 1].triangle;
            edge.same_winding = uses[i].forward != uses[i + 1].forward;
            edges.neighbour[edge.triangle][edge.edge] = edge.other;
            edges.neighbour[edge.other][uses[i + 1].edge] = edge.triangle;
            if (!describe_pair(edges, rules, edge)) continue;
        }
        edges.edge.push_back(edge);
    }
    index_by_vertex(edges, vertex_count);
    return edges;
}

bool is_silhouette(const DrawnEdges& edges, const DrawnEdge& edge, const Vec3& direction) {
    if (edge.other == kNone) return false;
    const double here = dot(edges.normal[edge.triangle], direction);
    const double there = dot(edges.normal[edge.other], direction) * (edge.same_winding ? 1 : -1);
    return (here > 0) != (there > 0);
}

}  // namespace trilens
