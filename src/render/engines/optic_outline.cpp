#include "render/engines/rim_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "base/util/parallel.h"

namespace trilens {
namespace {

/// How much farther the surface may stray from a facet than at the samples: a quadratic patch 4/3 as far
/// inside as at the middles of its edges.
constexpr double kSafety = 1.5;
/// Pixels by which a band is wider, and under which an outline counts as exact.
constexpr double kRoom = 0.25, kExact = 1e-3;
constexpr std::size_t kFacetsPerTask = 64;

constexpr double kThird = 1.0 / 3;
constexpr std::array<Vec3, 7> kSamples{Vec3(0, 0.5, 0.5),
                                       Vec3(0.5, 0, 0.5),
                                       Vec3(0.5, 0.5, 0),
                                       Vec3(kThird),
                                       Vec3(2.0 / 3, 1. / 6, 1. / 6),
                                       Vec3(1. / 6, 2.0 / 3, 1. / 6),
                                       Vec3(1. / 6, 1. / 6, 2.0 / 3)};

/// One side of an edge: the points at its ends, lower first, and the branch of the camera that shows it.
struct EdgeSide {
    Id a = kNone, b = kNone;
    std::size_t branch = 0;
    Id original = kNone;  // the surface's facet
    Id facet = kNone;     // the film's
    std::uint8_t edge = 0;
    bool front = false;

    bool is_beside(const EdgeSide& other) const {
        return a == other.a && b == other.b && branch == other.branch;
    }
    auto operator<=>(const EdgeSide&) const = default;
};

class OutlineFinder {
  public:
    OutlineFinder(const World& world, const Frame& frame, std::size_t optic)
        : surface_(*world.optics[optic].surface),
          frame_(frame),
          framed_(frame.optics[optic]),
          camera_(frame.camera),
          grid_(framed_.film_grid ? framed_.film_grid->grid : framed_.facets->grid()),
          points_(framed_.facets->grid().points) {
        if (framed_.film_grid)
            views_ = framed_.film_grid->views;
        else
            views_ = corner_views(grid_, *camera_.linear);
    }
    std::vector<OutlineEdge> find();

  private:
    std::size_t branch_of(std::size_t facet) const {
        return framed_.film_grid ? framed_.film_grid->branch[facet] : 0;
    }
    const Vec3& point(Id corner) const { return points_[grid_.corner_point[corner]]; }
    std::optional<Vec2> image(const Vec3& point, std::size_t branch) const;
    std::optional<Vec2> stray(std::size_t facet, const Vec3& weights) const;
    double stray_of(std::size_t facet) const;
    std::vector<EdgeSide> sides() const;
    std::vector<EdgeSide> outline() const;
    std::vector<double> strays_at_points(const std::vector<char>& asked) const;
    std::optional<OutlineEdge> edge_at(const EdgeSide& side, double off) const;

    const Surface& surface_;
    const Frame& frame_;
    const FramedOptic& framed_;
    const Camera& camera_;
    const SurfaceGrid& grid_;  // of the film, where the camera is not linear
    const std::vector<Vec3>& points_;
    std::vector<CornerView> views_;
};

std::optional<Vec2> OutlineFinder::image(const Vec3& point, std::size_t branch) const {
    if (camera_.linear) {
        const Vec3 screen = screen_from_world(*camera_.linear, point);
        if (!(screen.z > 0)) return std::nullopt;
        return Vec2(screen) / screen.z;
    }
    const std::optional<FilmImage> place = framed_.model->place(point, branch);
    if (!place) return std::nullopt;
    return place->pixel;
}

/// From where the film shows a point of the facet to where it shows that of the surface.
std::optional<Vec2> OutlineFinder::stray(std::size_t facet, const Vec3& weights) const {
    Vec2 uv(0);
    Vec3 chord(0);
    for (std::size_t k = 0; k < 3; ++k) {
        uv += weights[static_cast<int>(k)] * grid_.facet_uv[facet][k];
        chord += weights[static_cast<int>(k)] * point(grid_.facets[facet][k]);
    }
    const Vec3 exact = surface_.eval_first_order(grid_.facet_face[facet], uv).position;
    const auto from = image(chord, branch_of(facet)), to = image(exact, branch_of(facet));
    if (!from || !to) return std::nullopt;
    Vec2 off = *to - *from;
    const double period = framed_.model ? framed_.model->period() : 0;
    if (period > 0) off.x -= period * std::round(off.x / period);
    return off;
}

double OutlineFinder::stray_of(std::size_t facet) const {
    double most = 0;
    for (const Vec3& weights : kSamples)
        if (const auto off = stray(facet, weights)) most = std::max(most, length(*off));
    return most;
}

/// Of all edges, those of one edge side by side.
std::vector<EdgeSide> OutlineFinder::sides() const {
    std::vector<EdgeSide> sides(3 * grid_.facets.size());
    parallel_for(grid_.facets.size(), kFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            const IdTriple& corners = grid_.facets[f];
            const bool front = faces_front(grid_, corners, views_[corners[0]].incident);
            const Id facet = static_cast<Id>(f);
            for (std::size_t k = 0; k < 3; ++k) {
                const auto [a, b] =
                    std::minmax(grid_.corner_point[corners[k]], grid_.corner_point[corners[(k + 1) % 3]]);
                sides[3 * f + k] = {
                    a,    b, branch_of(f), framed_.grid_facet(facet), facet, static_cast<std::uint8_t>(k),
                    front};
            }
        }
    });
    std::sort(sides.begin(), sides.end());
    return sides;
}

/// One side of each edge of the outline, wherever a film shows it.
std::vector<EdgeSide> OutlineFinder::outline() const {
    const std::vector<EdgeSide> all = sides();
    std::vector<EdgeSide> outline;
    for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
        bool is_one_side = true;  // facets on both sides show the same
        int facets = 0;           // one that a film shows twice counts once
        for (; last < all.size() && all[last].is_beside(all[first]); ++last) {
            facets += last == first || all[last].original != all[last - 1].original;
            is_one_side = is_one_side && all[last].front == all[first].front;
        }
        if (all[first].a == all[first].b || (facets == 2 && is_one_side)) continue;
        for (std::size_t i = first; i < last && all[i].original == all[first].original; ++i)
            outline.push_back(all[i]);
    }
    return outline;
}

/// Per point the most that a facet around it strays, where it is asked for.
std::vector<double> OutlineFinder::strays_at_points(const std::vector<char>& asked) const {
    std::vector<double> of_facet(grid_.facets.size(), 0);
    parallel_for(of_facet.size(), kFacetsPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t f = from; f < to; ++f) {
            frame_.stop_if_cancelled();
            const IdTriple& corners = grid_.facets[f];
            if (std::any_of(corners.begin(), corners.end(),
                            [&](Id corner) { return asked[grid_.corner_point[corner]] != 0; }))
                of_facet[f] = stray_of(f);
        }
    });
    std::vector<double> most(points_.size(), 0);
    for (std::size_t f = 0; f < of_facet.size(); ++f)
        for (const Id corner : grid_.facets[f])
            most[grid_.corner_point[corner]] = std::max(most[grid_.corner_point[corner]], of_facet[f]);
    return most;
}

std::optional<OutlineEdge> OutlineFinder::edge_at(const EdgeSide& side, double off) const {
    const IdTriple& corners = grid_.facets[side.facet];
    const Vec3 &from = views_[corners[side.edge]].screen, &to = views_[corners[(side.edge + 1) % 3]].screen;
    if (!(from.z > 0 && to.z > 0)) return std::nullopt;
    OutlineEdge edge{{Vec2(from) / from.z, Vec2(to) / to.z}, off, 0};
    Vec3 middle(0.5);
    middle[(side.edge + 2) % 3] = 0;
    const Vec2 along = edge.end[1] - edge.end[0];
    if (const auto to_surface = stray(side.facet, middle)) {
        const double across = std::fabs(along.x * to_surface->y - along.y * to_surface->x);
        edge.inset = length(along) > 0 ? across / length(along) : length(*to_surface);
    }
    return edge;
}

std::vector<OutlineEdge> OutlineFinder::find() {
    const std::vector<EdgeSide> found = outline();
    std::vector<char> asked(points_.size(), 0);
    for (const EdgeSide& side : found) asked[side.a] = asked[side.b] = 1;
    const std::vector<double> strays = strays_at_points(asked);
    std::vector<OutlineEdge> edges;
    for (const EdgeSide& side : found) {
        const double off = std::max(strays[side.a], strays[side.b]);
        if (!(off > kExact)) continue;
        if (const auto edge = edge_at(side, off)) edges.push_back(*edge);
    }
    return edges;
}

double distance_to(const OutlineEdge& edge, const Vec2& at) {
    const Vec2 along = edge.end[1] - edge.end[0], from = at - edge.end[0];
    const double square = dot(along, along);
    const double t = square > 0 ? std::clamp(dot(from, along) / square, 0.0, 1.0) : 0;
    return length(from - t * along);
}

}  // namespace

std::vector<OutlineEdge> optic_outline(const World& world, const Frame& frame, std::size_t optic) {
    return OutlineFinder(world, frame, optic).find();
}

double outline_area(std::span<const OutlineEdge> edges, double limit, const SampleGrid& window,
                    const std::function<bool(const Vec2&)>& shows) {
    constexpr int kPlaces = 8;      // along an edge, which may be in the window in part
    constexpr double kAside = 1.5;  // pixels
    const auto inside = [&](const Vec2& at) {
        return at.x >= window.x0 && at.x < window.x1 && at.y >= window.y0 && at.y < window.y1;
    };
    double area = 0;
    for (const OutlineEdge& edge : edges) {
        const Vec2 along = edge.end[1] - edge.end[0];
        const double size = length(along);
        if (is_off(edge, limit) || !(size > 0)) continue;
        const Vec2 aside = kAside / size * Vec2(-along.y, along.x);
        int counted = 0;
        for (int i = 0; i < kPlaces; ++i) {
            const Vec2 at = edge.end[0] + (i + 0.5) / kPlaces * along, one = at + aside, other = at - aside;
            counted += inside(at) && inside(one) && inside(other) && shows(one) != shows(other);
        }
        area += 2.0 / 3 * size * edge.inset * counted / kPlaces;
    }
    return area;
}

double surface_stray(const Surface& surface, const SurfaceGrid& grid, Id facet) {
    double most = 0;
    for (const Vec3& weights : kSamples) {
        Vec2 uv(0);
        Vec3 chord(0);
        for (std::size_t k = 0; k < 3; ++k) {
            uv += weights[static_cast<int>(k)] * grid.facet_uv[facet][k];
            chord += weights[static_cast<int>(k)] * grid.points[grid.corner_point[grid.facets[facet][k]]];
        }
        most = std::max(most, length(surface.eval_first_order(grid.facet_face[facet], uv).position - chord));
    }
    return kSafety * most;
}

bool is_off(const OutlineEdge& edge, double limit) {
    return kSafety * edge.off > limit;
}

double outline_room(const OutlineEdge& edge) {
    return kSafety * edge.off + kRoom;
}

void mark_near_outline(std::span<const OutlineEdge> edges, double limit, const SampleGrid& grid,
                       std::span<char> near) {
    for (const OutlineEdge& edge : edges) {
        if (!is_off(edge, limit)) continue;
        const double room = outline_room(edge);
        const Vec2 low = glm::min(edge.end[0], edge.end[1]) - room,
                   high = glm::max(edge.end[0], edge.end[1]) + room;
        const auto within = [](double x, int from, int to) {
            return static_cast<int>(std::clamp(x, static_cast<double>(from), static_cast<double>(to)));
        };
        const int x0 = within(std::floor(low.x), grid.x0, grid.x1),
                  x1 = within(std::ceil(high.x), grid.x0, grid.x1);
        const int y0 = within(std::floor(low.y), grid.y0, grid.y1),
                  y1 = within(std::ceil(high.y), grid.y0, grid.y1);
        if (x0 >= x1 || y0 >= y1) continue;
        const auto mark = [&](std::size_t s) {
            if (!near[s] && distance_to(edge, grid.position(s)) <= room) near[s] = 1;
        };
        if (!grid.chosen.empty()) {
            for (std::size_t s = 0; s < near.size(); ++s) mark(s);
            continue;
        }
        SampleGrid window = grid;
        window.x0 = x0, window.x1 = x1, window.y0 = y0, window.y1 = y1;
        const std::size_t run = window.size() / window.runs();
        for (std::size_t y = 0; y < window.runs(); ++y) {
            const std::size_t first = window.sample_in(grid, y * run);
            for (std::size_t s = first; s < first + run; ++s) mark(s);
        }
    }
}

}  // namespace trilens
