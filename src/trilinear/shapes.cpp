// The shapes of a scene triangle in a facet (Vallance 2005, chapter 4): sort, merge, join.
#include "trilinear/outline.h"

#include <algorithm>
#include <cmath>

#include "base/math/roots.h"

namespace trilens {
namespace {

// A place where two outlines of edges meet: a root of a scene vertex, or an edge cut by an end of the window.
struct Node {
    double t = 0;
    int corner = -1;    // of a root
    int cut_edge = -1;  // of a cut
    int joined[2] = {-1, -1};
    int along[2] = {kSlice, kSlice};
    int degree = 0;
};

struct Graph {
    std::array<Node, 16> node;  // 9 roots and at most 2 cuts at each end of the window
    int count = 0;

    int add(const Node& n) {
        node[static_cast<std::size_t>(count)] = n;
        return count++;
    }
    Node& operator[](int i) { return node[static_cast<std::size_t>(i)]; }
    void join(int a, int b, int along) {
        for (const int pair : {0, 1}) {
            Node& n = (*this)[pair ? b : a];
            n.joined[n.degree] = pair ? a : b;
            n.along[n.degree] = along;
            ++n.degree;
        }
    }
};

// Which side of the plane a scene vertex is on where the window begins: the sign far before all roots, turned
// by each root up to there. Counting, unlike evaluating, agrees with the roots themselves.
bool positive_at_begin(const std::array<double, 4>& c, const RealRoots& roots, double begin) {
    constexpr double t = -kFarthestRoot;
    bool positive = ((c[3] * t + c[2]) * t + c[1]) * t + c[0] > 0;
    for (const double r : roots) positive ^= r <= begin;
    return positive;
}

// Joins what lies on one scene edge; `nodes` are the roots of both its ends in the window.
void connect_edge(Graph& graph, std::vector<int>& nodes, int edge, bool cut_at_begin, const Window& window,
                  std::vector<int> (&cuts)[2]) {
    std::sort(nodes.begin(), nodes.end(),
              [&](int a, int b) { return graph[a].t != graph[b].t ? graph[a].t < graph[b].t : a < b; });
    const auto add_cut = [&](double t, std::vector<int>& same_end) {
        Node cut;
        cut.t = t, cut.cut_edge = edge;
        same_end.push_back(graph.add(cut));
        return same_end.back();
    };
    if (cut_at_begin) nodes.insert(nodes.begin(), add_cut(window.begin, cuts[0]));
    if (nodes.size() % 2) nodes.push_back(add_cut(window.end, cuts[1]));
    for (std::size_t i = 0; i + 1 < nodes.size(); i += 2) graph.join(nodes[i], nodes[i + 1], edge);
}

// Walks once around from node `start`; clears the degree of what it passes.
Shape trace(Graph& graph, int start, const Coplanarity& facet, const SceneTriangle& triangle, bool& placed) {
    Shape shape;
    int at = start, from = -1, came_along = -1;
    do {
        Node& node = graph[at];
        // Leave by the way not come by; two nodes may be joined twice, along different edges.
        const int way = node.joined[0] == from && node.along[0] == came_along ? 1 : 0;
        ShapeVertex vertex;
        vertex.corner = node.corner, vertex.edge = node.along[way];
        if (node.corner >= 0) {
            const std::size_t k = static_cast<std::size_t>(node.corner);
            const auto weights = weights_in_parametric_triangle(facet, node.t, triangle.corner[k]);
            placed &= weights.has_value();
            vertex.at = {node.t, weights.value_or(Vec3(0)), Vec3(0)};
            vertex.at.barycentric[node.corner] = 1;
        } else {
            const auto cut = edge_cut(facet, triangle, static_cast<std::size_t>(node.cut_edge), node.t);
            placed &= cut.has_value();
            vertex.at = cut.value_or(ImageVertex{});
        }
        shape.push_back(vertex);
        node.degree = 0;
        from = at, came_along = node.along[way], at = node.joined[way];
    } while (at != start);
    return shape;
}

}  // namespace

std::array<RealRoots, 3> project_vertices(const Coplanarity& facet, const SceneTriangle& triangle) {
    std::array<RealRoots, 3> roots;
    for (std::size_t k = 0; k < 3; ++k) roots[k] = real_roots(coplanarity_cubic(facet, triangle.corner[k]));
    return roots;
}

std::vector<Shape> make_shapes(const Coplanarity& facet, const SceneTriangle& triangle,
                               const Window& window) {
    // The roots inside the window, and the sides at its begin.
    Graph graph;
    std::vector<int> of_corner[3];
    bool positive[3];
    const std::array<RealRoots, 3> roots = project_vertices(facet, triangle);
    for (std::size_t k = 0; k < 3; ++k) {
        if (roots[k].all) return {};
        positive[k] = positive_at_begin(coplanarity_cubic(facet, triangle.corner[k]), roots[k], window.begin);
        for (const double t : roots[k]) {
            if (!(t > window.begin && t < window.end)) continue;
            Node node;
            node.t = t, node.corner = static_cast<int>(k);
            of_corner[k].push_back(graph.add(node));
        }
    }

    // Join along the three edges, and the cuts of each end of the window with one another.
    std::vector<int> cuts[2];
    for (std::size_t e = 0; e < 3; ++e) {
        std::vector<int> nodes = of_corner[e];
        const std::vector<int>& other = of_corner[(e + 1) % 3];
        nodes.insert(nodes.end(), other.begin(), other.end());
        connect_edge(graph, nodes, static_cast<int>(e), positive[e] != positive[(e + 1) % 3], window, cuts);
    }
    for (const std::vector<int>& cut : cuts) {
        if (cut.size() == 2) graph.join(cut[0], cut[1], kSlice);
    }

    // Closed walks, the one with the earliest vertex first.
    std::vector<int> order;
    for (int i = 0; i < graph.count; ++i) order.push_back(i);
    std::sort(order.begin(), order.end(),
              [&](int a, int b) { return graph[a].t != graph[b].t ? graph[a].t < graph[b].t : a < b; });
    std::vector<Shape> shapes;
    for (const int start : order) {
        if (graph[start].degree == 0) continue;
        bool placed = true;
        Shape shape = trace(graph, start, facet, triangle, placed);
        if (placed) shapes.push_back(std::move(shape));
    }
    return shapes;
}

// Which stretches of t a facet sees of a scene triangle.

namespace {

// Where the facet's rays turn back or run very far apart, t is followed up to this many times the distance to
// the triangle in units of the longest direction.
constexpr double kFarthestView = 1e6;

// Where the rays start from one point or line, t is followed from this share of that distance on.
constexpr double kNearestView = 1e-9;

// No ray with weights in [0, 1] meets the triangle after the window's end; its begin is near, but not zero.
Window reach_of(const Coplanarity& facet, const SceneTriangle& triangle) {
    const Vec3 o[3] = {facet.origin, facet.origin + facet.e1, facet.origin + facet.e2};
    const Vec3 d[3] = {facet.direction, facet.direction + facet.f1, facet.direction + facet.f2};
    double reach = 0, longest = 0;
    Vec3 axis(0);
    for (int k = 0; k < 3; ++k) {
        for (const Vec3& corner : triangle.corner) reach = std::max(reach, length(corner - o[k]));
        longest = std::max(longest, length(d[k]));
        axis += normalize_or_zero(d[k]);
    }
    if (longest == 0 || reach == 0) return {0, 0};

    // Along an axis that all directions share, every ray advances at least this much per t.
    axis = normalize_or_zero(axis);
    const double advance = std::min({dot(d[0], axis), dot(d[1], axis), dot(d[2], axis)});
    const double unit = reach / longest;
    const double farthest =
        advance > 0 ? std::min(reach / advance, kFarthestView * unit) : kFarthestView * unit;
    return {kNearestView * unit, farthest * (1 + kCollapseGap)};
}

}  // namespace

std::vector<Window> view_windows(const Coplanarity& facet, const SceneTriangle& triangle) {
    const auto [near, end] = reach_of(facet, triangle);
    if (!(end > 0)) return {};

    // Where the normal vanishes, so does its component along any of its own coefficients: a quadratic. Two
    // such roots that rounding keeps apart or makes complex lie about the quadratic's extremum.
    const Vec3 &n0 = facet.n0, &n1 = facet.n1, &n2 = facet.n2;
    const Vec3 along = length(n0) > 0 ? n0 : length(n1) > 0 ? n1 : n2;
    if (length(along) == 0) return {};
    const std::array<double, 3> q{dot(along, n0), dot(along, n1), dot(along, n2)};
    std::vector<double> candidates;
    if (q[2] != 0) candidates.push_back(-q[1] / q[2] / 2);
    for (const double t : real_roots({q[0], q[1], q[2], 0})) candidates.push_back(t);
    std::stable_sort(candidates.begin(), candidates.end());

    std::vector<Window> windows{Window{0, end}};
    const auto collapsed = [&](double t) {
        const double parts = length(n0) + t * (length(n1) + t * length(n2));
        return !(length(n0 + t * (n1 + t * n2)) > kCollapsed * parts);
    };
    if (collapsed(0)) windows[0].begin = near;
    for (const double t : candidates) {
        if (!(t > windows.back().begin && t < end) || !collapsed(t)) continue;
        windows.back().end = std::max(windows.back().begin, t * (1 - kCollapseGap));
        windows.push_back({t * (1 + kCollapseGap), end});
    }
    return windows;
}

}  // namespace trilens
