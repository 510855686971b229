#include "vector/drawing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/parallel.h"
#include "trilinear/outline.h"
#include "vector/caustic.h"

namespace trilens {
namespace {

constexpr double kStep = 0.4;      // pixels between tests along an arc
constexpr int kMostSteps = 8000;   // on one arc; longer ones lie mostly off the film
constexpr double kBefore = 1e-3;   // a surface nearer than the edge by this share of t hides it
constexpr double kOutside = 1e-9;  // how far weights may leave [0, 1] on the facet's border
constexpr double kShortest =
    1.0;  // pixels: visible pieces and hidden gaps below this are rounding of the test

/// What a point of an edge is to the picture. kBeside: not seen, but no farther than a sample from what is
/// seen of its own triangles, as where an edge stands a hair below a floor.
enum class Sight : char { kHidden, kBeside, kSeen };

/// One facet at work.
class FacetPen {
  public:
    FacetPen(const VectorView& view, Id facet, std::vector<Id> ring)
        : view_(view),
          facet_(facet),
          ring_(std::move(ring)),
          rays_(trilinear_facet(view.mesh, facet)),
          cubic_(make_coplanarity(rays_)) {
        for (int k = 0; k < 3; ++k)
            screen_[k] = view.mesh.screen[view.mesh.facets[facet][static_cast<std::size_t>(k)]];
    }

    /// Edges whose images this facet may show, ascending.
    std::vector<Id> candidates(std::span<const Id> samples) const;
    void draw(const DrawnEdge& edge, std::vector<EdgeCurve>& curves) const;

  private:
    struct Edge {
        const DrawnEdge& drawn;
        Vec3 a, b;
    };

    SceneTriangle triangle(Id index) const {
        const IdTriple& c = view_.scene.triangles[index];
        return {{view_.scene.points[c[0]], view_.scene.points[c[1]], view_.scene.points[c[2]]}};
    }
    std::vector<Section> sides(const SceneTriangle& scene_triangle, std::size_t edge) const;
    void cut(const Edge& edge, const ConicArc& arc, std::vector<EdgeCurve>& curves) const;
    Sight sight(const Edge& edge, const Vec3& weights) const;
    Sight among_samples(const Edge& edge, const Vec3& weights, const Vec2& at) const;

    const VectorView& view_;
    Id facet_;
    std::vector<Id> ring_;
    TrilinearFacet rays_;
    Coplanarity cubic_;
    Mat3 screen_{0};
};

std::vector<Id> FacetPen::candidates(std::span<const Id> samples) const {
    std::vector<Id> found;
    if (view_.wire) {
        for (Id e = 0; e < view_.edges.edge.size(); ++e) found.push_back(e);
        return found;
    }
    // What is seen at the facet's samples and beside them, and the edges around it.
    const SampleLattice lattice{view_.grid};
    std::vector<Id> seen;
    for (const Id s : samples) {
        const int column = lattice.column(s), row = lattice.row(s);
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                if (!lattice.holds(column + dx, row + dy)) continue;
                const Id triangle_there = view_.triangle[lattice.sample(column + dx, row + dy)];
                if (triangle_there != kNone && (seen.empty() || seen.back() != triangle_there))
                    seen.push_back(triangle_there);
            }
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (const Id t : seen)
        for (const Id vertex : view_.edges.vertex_of[t])
            for (const Id e : view_.edges.at(vertex)) found.push_back(e);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

/// The sides of the triangle's shapes along one of its edges, t >= 0.
std::vector<Section> FacetPen::sides(const SceneTriangle& scene_triangle, std::size_t edge) const {
    std::vector<Section> sides;
    for (const Window& window : view_windows(cubic_, scene_triangle))
        for (const Shape& shape : make_shapes(cubic_, scene_triangle, window))
            for (std::size_t i = 0; i < shape.size(); ++i)
                if (shape[i].edge == static_cast<int>(edge))
                    sides.push_back({shape[i].at, shape[(i + 1) % shape.size()].at, shape[i].edge});
    return sides;
}

void FacetPen::draw(const DrawnEdge& drawn, std::vector<EdgeCurve>& curves) const {
    const SceneTriangle scene_triangle = triangle(drawn.triangle);
    if (!may_image(rays_, scene_triangle)) return;
    const Edge edge{drawn, scene_triangle.from(drawn.edge), scene_triangle.to(drawn.edge)};
    for (const Section& side : sides(scene_triangle, drawn.edge))
        for (const ConicArc& arc : edge_arcs_inside(cubic_, scene_triangle, side)) cut(edge, arc, curves);
}

/// Appends the arc's shown pieces; a piece that begins where the last curve ended continues it.
void FacetPen::cut(const Edge& edge, const ConicArc& arc, std::vector<EdgeCurve>& curves) const {
    const ScreenArc screen = on_screen(arc, screen_);
    if (!(screen[0].z > 0 && screen[1].z > 0 && screen[2].z > 0)) return;  // partly behind the camera
    const auto pixel = [](const Vec3& p) { return Vec2(p.x / p.z, p.y / p.z); };
    const double around =
        length(pixel(screen[1]) - pixel(screen[0])) + length(pixel(screen[2]) - pixel(screen[1]));
    const int steps = static_cast<int>(std::clamp(around / kStep, 4.0, static_cast<double>(kMostSteps)));
    std::vector<char> shown(static_cast<std::size_t>(steps)), beside(shown);
    for (int i = 0; i < steps; ++i) {
        const Sight seen = sight(edge, arc.weights((i + 0.5) / steps));
        shown[static_cast<std::size_t>(i)] = seen == Sight::kSeen;
        beside[static_cast<std::size_t>(i)] = seen == Sight::kBeside;
    }

    // Gaps shorter than the test can tell are closed, and those that never leave what is seen of the edge's
    // triangles, which would make it dashed; then runs become pieces.
    const int least = static_cast<int>(std::ceil(kShortest * steps / std::max(around, kShortest)));
    const auto run_end = [&](int from) {
        int end = from;
        while (end < steps && shown[static_cast<std::size_t>(end)] == shown[static_cast<std::size_t>(from)])
            ++end;
        return end;
    };
    for (int i = 0, end = 0; i < steps; i = end) {
        end = run_end(i);
        if (!shown[static_cast<std::size_t>(i)] && i > 0 && end < steps &&
            (end - i < least || std::all_of(beside.begin() + i, beside.begin() + end, std::identity{})))
            std::fill(shown.begin() + i, shown.begin() + end, 1);
    }
    for (int i = 0, end = 0; i < steps; i = end) {
        end = run_end(i);
        const bool whole = i == 0 && end == steps;
        if (!shown[static_cast<std::size_t>(i)] || (!whole && i > 0 && end < steps && end - i < least))
            continue;
        const ScreenArc piece = whole ? screen : piece_of(screen, 1.0 * i / steps, 1.0 * end / steps);
        const bool joins = i == 0 && !curves.empty() && curves.back().triangle == edge.drawn.triangle &&
                           length(point_of(curves.back().arcs.back(), 1) - point_of(piece, 0)) < 1e-6;
        if (!joins) curves.push_back({edge.drawn.triangle, facet_, {}});
        curves.back().arcs.push_back(piece);
    }
}

Sight FacetPen::sight(const Edge& edge, const Vec3& weights) const {
    if (std::min({weights.x, weights.y, weights.z}) < -kOutside) return Sight::kHidden;
    const Vec3 homogeneous = screen_ * weights;
    const Vec2 at(homogeneous.x / homogeneous.z, homogeneous.y / homogeneous.z);
    const SampleGrid& grid = view_.grid;
    if (!(at.x >= grid.x0 && at.x <= grid.x1 && at.y >= grid.y0 && at.y <= grid.y1)) return Sight::kHidden;
    if (!edge.drawn.always && !is_silhouette(view_.edges, edge.drawn, rays_.direction(weights)))
        return Sight::kHidden;
    return view_.wire ? Sight::kSeen : among_samples(edge, weights, at);
}

Sight FacetPen::among_samples(const Edge& edge, const Vec3& weights, const Vec2& at) const {
    // Where the ray passes the edge: closest approach, with the edge's own direction taken out.
    const Vec3 along = edge.b - edge.a, origin = rays_.origin(weights) - edge.a,
               direction = rays_.direction(weights);
    const Vec3 across = direction - along * (dot(direction, along) / dot(along, along));
    const double t = -dot(across, origin) / dot(across, direction);

    const SampleGrid& grid = view_.grid;
    const int column = static_cast<int>(std::floor((at.x - grid.x0) * grid.side - 0.5));
    const int row = static_cast<int>(std::floor((at.y - grid.y0) * grid.side - 0.5));
    const SampleLattice lattice{grid};
    // What the sample there shows, where it lies in this facet or beside it.
    const auto seen_at = [&](int x, int y) -> std::optional<Id> {
        if (!lattice.holds(x, y)) return std::nullopt;
        const std::size_t s = lattice.sample(x, y);
        if (!std::binary_search(ring_.begin(), ring_.end(), view_.facet[s])) return std::nullopt;
        return view_.triangle[s];
    };
    const auto is_own = [&](Id seen) {
        return seen != kNone && (seen == edge.drawn.triangle || seen == edge.drawn.other);
    };
    for (int k = 0; k < 4; ++k) {
        const std::optional<Id> seen = seen_at(column + k % 2, row + k / 2);
        if (!seen) continue;
        if (*seen == kNone || is_own(*seen)) return Sight::kSeen;
        const std::optional<ImageVertex> plane = plane_hit(rays_, triangle(*seen), weights);
        if (plane && (plane->t < 0 || plane->t >= t * (1 - kBefore))) return Sight::kSeen;
    }
    for (int dy = -1; dy <= 2; ++dy)
        for (int dx = -1; dx <= 2; ++dx)
            if (const std::optional<Id> seen = seen_at(column + dx, row + dy); seen && is_own(*seen))
                return Sight::kBeside;
    return Sight::kHidden;
}

}  // namespace

ScreenArc piece_of(const ScreenArc& arc, double u0, double u1) {
    const auto blossom = [&](double u, double v) {
        return (1 - u) * (1 - v) * arc[0] + (u * (1 - v) + v * (1 - u)) * arc[1] + u * v * arc[2];
    };
    return {blossom(u0, u0), blossom(u0, u1), blossom(u1, u1)};
}

Vec2 point_of(const ScreenArc& arc, double u) {
    const Vec3 p = (1 - u) * (1 - u) * arc[0] + 2 * u * (1 - u) * arc[1] + u * u * arc[2];
    return {p.x / p.z, p.y / p.z};
}

namespace {

constexpr int kMostHalvings = 16;

double distance_to_line(const Vec2& p, const Vec2& from, const Vec2& to) {
    const Vec2 along = to - from;
    const double square = dot(along, along);
    const double u = square > 0 ? std::clamp(dot(p - from, along) / square, 0.0, 1.0) : 0.0;
    return length(p - from - u * along);
}

/// All points of an arc lie in the triangle of its control points, so none is farther from the chord than the
/// middle one.
void append_polyline(const ScreenArc& arc, double tolerance, int halvings, std::vector<Vec2>& points) {
    const Vec2 from = point_of(arc, 0), to = point_of(arc, 1),
               middle(arc[1].x / arc[1].z, arc[1].y / arc[1].z);
    if (halvings > 0 && distance_to_line(middle, from, to) > tolerance) {
        append_polyline(piece_of(arc, 0, 0.5), tolerance, halvings - 1, points);
        append_polyline(piece_of(arc, 0.5, 1), tolerance, halvings - 1, points);
    } else {
        points.push_back(to);
    }
}

}  // namespace

std::vector<Vec2> polyline_of(const EdgeCurve& curve, double tolerance) {
    std::vector<Vec2> points;
    for (const ScreenArc& arc : curve.arcs) {
        if (points.empty()) points.push_back(point_of(arc, 0));
        append_polyline(arc, tolerance, kMostHalvings, points);
    }
    return points;
}

std::vector<EdgeCurve> edge_curves(const VectorView& view) {
    const FacetSamples owned = group_by_facet(view.facet, view.mesh.facets.size());
    const FacetsAround around = facets_around(view.mesh.facets, view.mesh.rays.size());
    std::vector<std::vector<EdgeCurve>> of_facet(view.mesh.facets.size());
    parallel_for(view.mesh.facets.size(), 4, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            if (!view.mesh.has_rays(f) || owned.of(f).empty()) continue;
            const FacetPen pen(view, static_cast<Id>(f), around.ring(view.mesh.facets[f]));
            for (const Id e : pen.candidates(owned.of(f))) pen.draw(view.edges.edge[e], of_facet[f]);
        }
    });
    std::vector<EdgeCurve> curves;
    for (std::vector<EdgeCurve>& some : of_facet)
        for (EdgeCurve& curve : some) curves.push_back(std::move(curve));
    return curves;
}

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
    const std::vector<Use> uses = sorted_uses(edges.vertex_of);
    for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
        while (end < uses.size() && uses[end].low == uses[i].low && uses[end].high == uses[i].high) ++end;
        DrawnEdge edge{uses[i].triangle, uses[i].edge, kNone, true, true};
        if (end - i == 2) {
            edge.other = uses[i + 1].triangle;
            edge.same_winding = uses[i].forward != uses[i + 1].forward;
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
