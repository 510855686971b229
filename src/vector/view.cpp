#include "vector/drawing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/parallel.h"
#include "trilinear/outline.h"
#include "vector/caustic.h"
#include "vector/facet_edges.h"

namespace trilens {
namespace {

constexpr double kStep = 0.4;      // pixels between tests along an arc
constexpr int kMostSteps = 8000;   // on one arc; longer ones lie mostly off the film
constexpr double kBefore = 1e-3;   // a surface nearer than the edge by this share of t hides it
constexpr double kOutside = 1e-9;  // how far weights may leave [0, 1] on the facet's border
constexpr double kAlongBorder = 1e-10;  // a weight that an arc on the facet's border has all along
constexpr double kShortest =
    1.0;  // pixels: visible pieces and hidden gaps below this are rounding of the test

/// What a point of an edge is to the picture. kBeside: not seen, but no farther than a sample from what is
/// seen of its own triangles, as where an edge stands a hair below a floor.
enum class Sight : char { kHidden, kBeside, kSeen };

/// One facet at work.
class FacetPen {
  public:
    FacetPen(const VectorView& view, const FacetSamples& owned, Id facet, std::vector<Id> ring)
        : view_(view),
          owned_(owned),
          facet_(facet),
          ring_(std::move(ring)),
          rays_(trilinear_facet(view.mesh, facet)),
          cubic_(make_coplanarity(rays_)) {
        for (int k = 0; k < 3; ++k)
            screen_[k] = view.mesh.screen[view.mesh.facets[facet][static_cast<std::size_t>(k)]];
    }

    void draw(std::vector<EdgeCurve>& curves) const {
        for (const Id e : edges_at_samples(view_, facet_, owned_.of(facet_))) draw_edge(e, curves);
    }

  private:
    struct Edge {
        const DrawnEdge& drawn;
        Vec3 a, b;
    };

    SceneTriangle triangle(Id index) const {
        const IdTriple& c = view_.scene.triangles[index];
        return {{view_.scene.points[c[0]], view_.scene.points[c[1]], view_.scene.points[c[2]]}};
    }
    void draw_edge(Id index, std::vector<EdgeCurve>& curves) const;
    bool is_left_to_neighbour(const ConicArc& arc, Id index) const;
    std::vector<Section> sides(const SceneTriangle& scene_triangle, std::size_t edge) const;
    void cut(const Edge& edge, const ConicArc& arc, std::vector<EdgeCurve>& curves) const;
    Sight sight(const Edge& edge, const Vec3& weights) const;
    Sight among_samples(const Edge& edge, const Vec3& weights, const Vec2& at) const;

    const VectorView& view_;
    const FacetSamples& owned_;
    Id facet_;
    std::vector<Id> ring_;
    TrilinearFacet rays_;
    Coplanarity cubic_;
    Mat3 screen_{0};
};

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

/// Along a border the facet with the lower index draws, if it draws at all.
bool FacetPen::is_left_to_neighbour(const ConicArc& arc, Id index) const {
    const IdTriple& corners = view_.mesh.facets[facet_];
    for (int k = 0; k < 3; ++k) {
        const auto& [c0, c1, c2] = arc.control;
        if (std::max({std::fabs(c0[k]), std::fabs(c1[k]), std::fabs(c2[k])}) > kAlongBorder) continue;
        for (const Id f : ring_) {
            const IdTriple& others = view_.mesh.facets[f];
            const auto has = [&](int corner) {
                const Id wanted = corners[static_cast<std::size_t>(corner % 3)];
                return std::find(others.begin(), others.end(), wanted) != others.end();
            };
            if (f >= facet_ || !has(k + 1) || !has(k + 2) || !view_.mesh.has_rays(f) || owned_.of(f).empty())
                continue;
            const std::vector<Id> drawn = edges_at_samples(view_, f, owned_.of(f));
            if (std::binary_search(drawn.begin(), drawn.end(), index)) return true;
        }
    }
    return false;
}

void FacetPen::draw_edge(Id index, std::vector<EdgeCurve>& curves) const {
    const DrawnEdge& drawn = view_.edges.edge[index];
    const SceneTriangle scene_triangle = triangle(drawn.triangle);
    if (!may_image(rays_, scene_triangle)) return;
    const Edge edge{drawn, scene_triangle.from(drawn.edge), scene_triangle.to(drawn.edge)};
    for (const Section& side : sides(scene_triangle, drawn.edge))
        for (const ConicArc& arc : edge_arcs_inside(cubic_, scene_triangle, side))
            if (!is_left_to_neighbour(arc, index)) cut(edge, arc, curves);
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
            FacetPen(view, owned, static_cast<Id>(f), around.ring(view.mesh.facets[f])).draw(of_facet[f]);
        }
    });
    std::vector<EdgeCurve> curves;
    for (std::vector<EdgeCurve>& some : of_facet)
        for (EdgeCurve& curve : some) curves.push_back(std::move(curve));
    return curves;
}

}  // namespace trilens
