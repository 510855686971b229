// Pieces of outlines closed along a facet's border, and polygons cut at it (Vallance 2005, section 5.1).
#include "trilinear/outline.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "trilinear/facet/scene_edge.h"

namespace trilens {
namespace {

// Joins chains whose ends lie on one line or ring, given as places along it: neighbouring ends are joined in
// pairs, first to second, or with `shifted` second to third and so on, the last to the first. `between` gives
// the vertices of the border from one place up to a higher one.
using Between = std::function<std::vector<ImageVertex>(double from, double to)>;

struct Border {
    std::vector<double> place;  // of the ends: chain c's first vertex is 2 c, its last 2 c + 1
    bool shifted = false;
    double around = 0;  // the ring's length
    Between between;
};

std::vector<Outline> join(const std::vector<Chain>& chains, const Border& border) {
    // Neighbours along the border.
    const std::size_t n = border.place.size();
    std::vector<std::size_t> order(n), rank(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return border.place[a] != border.place[b] ? border.place[a] < border.place[b] : a < b;
    });
    for (std::size_t i = 0; i < n; ++i) rank[order[i]] = i;

    std::vector<Outline> outlines;
    std::vector<char> used(chains.size(), 0);
    for (std::size_t first = 0; first < chains.size(); ++first) {
        if (used[first]) continue;
        Outline outline;
        std::size_t enter = 2 * first;
        do {
            // Along the chain, from the end entered to the other.
            const Chain& chain = chains[enter / 2];
            used[enter / 2] = 1;
            if (enter % 2 == 0)
                outline.vertex.insert(outline.vertex.end(), chain.begin(), chain.end());
            else
                outline.vertex.insert(outline.vertex.end(), chain.rbegin(), chain.rend());

            // Along the border to the neighbour: up it is one of an inside stretch's begin, down its end.
            const std::size_t leave = enter ^ 1, at = rank[leave];
            const bool up = (at % 2 == 0) != border.shifted;
            const std::size_t next = order[up ? (at + 1) % n : (at + n - 1) % n];
            double low = border.place[up ? leave : next], high = border.place[up ? next : leave];
            if (high < low || (up ? at + 1 == n : at == 0)) high += border.around;
            std::vector<ImageVertex> path = border.between(low, high);
            if (!up) std::reverse(path.begin(), path.end());
            outline.vertex.insert(outline.vertex.end(), path.begin(), path.end());
            enter = next;
        } while (enter != 2 * first);
        outlines.push_back(std::move(outline));
    }
    return outlines;
}

// A vertex at given weights: t and barycentrics are the ray's where it meets the triangle's plane.
ImageVertex at_weights(const FacetAndTriangle& pair, const Vec3& weights) {
    const auto hit = plane_hit(pair.facet, pair.triangle, weights);
    return hit ? *hit : ImageVertex{0, weights, Vec3(1.0 / 3)};
}

Vec3 corner_weights(int corner) {
    Vec3 w(0);
    w[corner] = 1;
    return w;
}

// Places around the facet: corner 0 at 0, corner 1 at 1, corner 2 at 2.
double place_on_border(const Vec3& w) {
    const int opposite = w.x == 0 ? 0 : w.y == 0 ? 1 : 2;
    return (opposite + 1) % 3 + std::clamp(w[(opposite + 2) % 3], 0.0, 1.0);
}

Vec3 weights_on_border(double place) {
    const double whole = std::floor(place), part = place - whole;
    const int corner = static_cast<int>(whole) % 3;
    return (1 - part) * corner_weights(corner) + part * corner_weights((corner + 1) % 3);
}

bool sees(const FacetAndTriangle& pair, const Vec3& weights) {
    const auto hit = plane_hit(pair.facet, pair.triangle, weights);
    return hit && hit->t >= 0 && std::min({hit->barycentric.x, hit->barycentric.y, hit->barycentric.z}) >= 0;
}

std::vector<ImageVertex> corners_between(const FacetAndTriangle& pair, double from, double to) {
    std::vector<ImageVertex> corners;
    for (int c = static_cast<int>(std::floor(from)) + 1; c < to; ++c) {
        corners.push_back(at_weights(pair, corner_weights(c % 3)));
    }
    return corners;
}

// The point of a polygon's side where weight k is zero.
ImageVertex side_crossing(const FacetAndTriangle& pair, const ImageVertex& a, const ImageVertex& b, int k) {
    const double share = a.weights[k] / (a.weights[k] - b.weights[k]);
    Vec3 w = a.weights + share * (b.weights - a.weights);
    w[k] = 0;
    w[(k + 2) % 3] = 1 - w[(k + 1) % 3];
    // What both ends are inside of, so is the point between, whatever rounding says.
    for (const int j : {(k + 1) % 3, (k + 2) % 3}) {
        if (a.weights[j] >= 0 && b.weights[j] >= 0) w[j] = std::max(w[j], 0.0);
    }
    return at_weights(pair, w);
}

// The runs of a polygon with weight k >= 0, each closed by the two crossings at its ends.
void cut_at_line(const FacetAndTriangle& pair, const Outline& outline, int k, std::vector<Chain>& chains,
                 std::vector<Outline>& whole) {
    const std::vector<ImageVertex>& v = outline.vertex;
    const std::size_t n = v.size();
    const auto in = [&](std::size_t i) { return v[i % n].weights[k] >= 0; };
    std::size_t out = 0;
    while (out < n && in(out)) ++out;
    if (out == n) {
        whole.push_back(outline);
        return;
    }
    Chain chain;
    for (std::size_t i = out; i < out + n; ++i) {
        if (in(i)) chain.push_back(v[i % n]);
        if (in(i) == in(i + 1)) continue;
        chain.push_back(side_crossing(pair, v[i % n], v[(i + 1) % n], k));
        if (in(i)) chains.push_back(std::move(chain)), chain.clear();
    }
}

}  // namespace

std::vector<Outline> join_along_border(const FacetAndTriangle& pair, const std::vector<Chain>& chains) {
    Border border;
    border.around = 3;
    border.between = [&](double from, double to) { return corners_between(pair, from, to); };
    for (const Chain& chain : chains) {
        border.place.push_back(place_on_border(chain.front().weights));
        border.place.push_back(place_on_border(chain.back().weights));
    }
    if (chains.empty()) {
        if (!sees(pair, weights_on_border(0.5))) return {};
        Outline all;
        for (int c = 0; c < 3; ++c) all.vertex.push_back(at_weights(pair, corner_weights(c)));
        return {all};
    }

    // Which stretches between neighbouring ends are inside: ask in the middle of the widest.
    std::vector<double> sorted = border.place;
    std::sort(sorted.begin(), sorted.end());
    std::size_t widest = sorted.size() - 1;
    double width = sorted.front() + 3 - sorted.back();
    for (std::size_t i = 0; i + 1 < sorted.size(); ++i) {
        if (sorted[i + 1] - sorted[i] > width) width = sorted[i + 1] - sorted[i], widest = i;
    }
    const bool inside = sees(pair, weights_on_border(sorted[widest] + 0.5 * width));
    border.shifted = inside != (widest % 2 == 0);
    return join(chains, border);
}

std::vector<Outline> clip_on_screen(const FacetAndTriangle& pair, std::vector<Outline> outlines) {
    for (int k = 0; k < 3; ++k) {
        std::vector<Chain> chains;
        std::vector<Outline> kept;
        for (const Outline& outline : outlines) cut_at_line(pair, outline, k, chains, kept);
        Border border;
        border.between = [](double, double) { return std::vector<ImageVertex>{}; };
        for (const Chain& chain : chains) {
            border.place.push_back(chain.front().weights[(k + 1) % 3]);
            border.place.push_back(chain.back().weights[(k + 1) % 3]);
        }
        for (Outline& closed : join(chains, border)) kept.push_back(std::move(closed));
        outlines = std::move(kept);
    }
    return outlines;
}

// Shapes cut where scene edges cross the surfaces that the facet's edges sweep (Vallance 2005, section 5.2).

namespace {

// A chain must end on the border; a scene vertex that lies on it to this share is moved there.
constexpr double kOnBorder = 1e-7;

// Two t that differ by less than this share are one: the parametric triangle between them moves by less than
// kOnBorder of the distance to it, and roots of two ends of one edge that should be equal differ by far less.
constexpr double kSameLevel = 1e-9;

double least(const Vec3& w) {
    return std::min({w.x, w.y, w.z});
}

// All crossings of one scene edge with the lines through the facet's three edges.
std::vector<ImageVertex> edge_crossings(const FacetAndTriangle& pair, std::size_t edge) {
    std::vector<ImageVertex> crossings;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        for (const SweepCrossing& c : sweep_crossings(pair.facet.corner[i], pair.facet.corner[j],
                                                      pair.triangle.from(edge), pair.triangle.to(edge))) {
            ImageVertex vertex{c.t, Vec3(0), Vec3(0)};
            vertex.weights[static_cast<int>(i)] = c.on_first,
            vertex.weights[static_cast<int>(j)] = c.on_second;
            vertex.barycentric[static_cast<int>(edge)] = c.on_a;
            vertex.barycentric[static_cast<int>((edge + 1) % 3)] = c.on_b;
            crossings.push_back(vertex);
        }
    }
    return crossings;
}

// The crossings of a slice: where the parametric triangle's sides meet the scene triangle's plane, each
// computed from one end whichever way the side runs.
std::vector<ImageVertex> slice_crossings(const FacetAndTriangle& pair, const Section& slice) {
    const double t = slice.from.t;
    std::array<Vec3, 3> c = pair.triangle.corner;
    std::sort(c.begin(), c.end(), [](const Vec3& a, const Vec3& b) { return canonically_before(a, b); });
    const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]);
    std::vector<ImageVertex> crossings;
    for (std::size_t k = 0; k < 3; ++k) {
        std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        if (canonically_before(pair.facet.corner[j], pair.facet.corner[i])) std::swap(i, j);
        const double at_i = dot(normal, pair.facet.corner_at(i, t) - c[0]);
        const double at_j = dot(normal, pair.facet.corner_at(j, t) - c[0]);
        if (at_i == at_j) continue;
        const double u = at_i / (at_i - at_j);
        ImageVertex vertex{t, Vec3(0), Vec3(0)};
        vertex.weights[static_cast<int>(i)] = 1 - u, vertex.weights[static_cast<int>(j)] = u;
        const Vec3 way = slice.to.weights - slice.from.weights;
        const double share = dot(vertex.weights - slice.from.weights, way) / dot(way, way);
        if (!(share > 0 && share < 1)) continue;
        vertex.barycentric = slice.from.barycentric + share * (slice.to.barycentric - slice.from.barycentric);
        crossings.push_back(vertex);
    }
    const auto distance = [&](const ImageVertex& v) { return length(v.weights - slice.from.weights); };
    std::sort(crossings.begin(), crossings.end(),
              [&](const ImageVertex& a, const ImageVertex& b) { return distance(a) < distance(b); });
    return crossings;
}

// The crossings of a scene edge's image in one slice: straight, so that the weights of its ends tell. The
// sweep cannot: where the edge is parallel to a side of the parametric triangle it has no crossing, and where
// it has, rounding puts its t on either side of the ends'. Computed from one end whichever way it runs.
std::vector<ImageVertex> level_crossings(const Section& section) {
    const bool turned = canonically_before(section.to.weights, section.from.weights);
    const ImageVertex &a = turned ? section.to : section.from, &b = turned ? section.from : section.to;
    struct Crossing {
        double share;
        ImageVertex vertex;
    };
    std::vector<Crossing> found;
    for (int k = 0; k < 3; ++k) {
        const double at_a = a.weights[k], at_b = b.weights[k];
        if (!((at_a < 0 && at_b > 0) || (at_a > 0 && at_b < 0))) continue;
        const double share = at_a / (at_a - at_b);
        ImageVertex v{a.t + share * (b.t - a.t), a.weights + share * (b.weights - a.weights),
                      a.barycentric + share * (b.barycentric - a.barycentric)};
        v.weights[k] = 0;
        v.weights[(k + 2) % 3] = 1 - v.weights[(k + 1) % 3];
        found.push_back({turned ? 1 - share : share, v});
    }
    std::sort(found.begin(), found.end(),
              [](const Crossing& first, const Crossing& second) { return first.share < second.share; });
    std::vector<ImageVertex> crossings;
    for (const Crossing& c : found) crossings.push_back(c.vertex);
    return crossings;
}

// The section divided at its crossings.
void divide(const FacetAndTriangle& pair, const Section& section,
            const std::array<std::vector<ImageVertex>, 3>& of_edge, std::vector<Section>& sections) {
    std::vector<ImageVertex> crossings;
    const double from = section.from.t, to = section.to.t;
    if (section.edge == kSlice) {
        crossings = slice_crossings(pair, section);
    } else if (is_level(section)) {
        crossings = level_crossings(section);
    } else {
        for (const ImageVertex& c : of_edge[static_cast<std::size_t>(section.edge)]) {
            if (c.t > std::min(from, to) && c.t < std::max(from, to)) crossings.push_back(c);
        }
        std::sort(crossings.begin(), crossings.end(), [&](const ImageVertex& a, const ImageVertex& b) {
            return from < to ? a.t < b.t : a.t > b.t;
        });
    }
    ImageVertex last = section.from;
    for (const ImageVertex& c : crossings) {
        sections.push_back({last, c, section.edge});
        last = c;
    }
    sections.push_back({last, section.to, section.edge});
}

Vec3 middle_weights(const FacetAndTriangle& pair, const Section& section) {
    const Vec3 middle = 0.5 * (section.from.weights + section.to.weights);
    if (is_level(section)) return middle;
    const auto cut = edge_cut(pair.cubic, pair.triangle, static_cast<std::size_t>(section.edge),
                              0.5 * (section.from.t + section.to.t));
    return cut ? cut->weights : middle;
}

// Where the triangle touches the facet along one of its edges, a section runs along the border and rounding
// alone tells on which side, and whether the border's rays meet the triangle.
bool runs_along_border(const FacetAndTriangle& pair, const Section& section) {
    const Vec3 &a = section.from.weights, &b = section.to.weights;
    if (length(b - a) <= kOnBorder) return false;
    const Vec3 middle = middle_weights(pair, section);
    for (int k = 0; k < 3; ++k) {
        if (std::max({std::fabs(a[k]), std::fabs(b[k]), std::fabs(middle[k])}) <= kOnBorder) return true;
    }
    return false;
}

// No border crosses a section, so one point between tells on which side it lies.
bool inside(const FacetAndTriangle& pair, const Section& section) {
    return least(middle_weights(pair, section)) >= 0;
}

bool move_to_border(ImageVertex& vertex) {
    Vec3& w = vertex.weights;
    int nearest = 0;
    for (int k = 1; k < 3; ++k) nearest = std::fabs(w[k]) < std::fabs(w[nearest]) ? k : nearest;
    if (!(std::fabs(w[nearest]) <= kOnBorder)) return false;
    if (w[nearest] != 0) {
        w[nearest] = 0;
        w /= w.x + w.y + w.z;
    }
    // At the facet's corners a crossing may overshoot by rounding.
    if (!(least(w) >= -kOnBorder)) return false;
    for (int k = 0; k < 3; ++k) {
        if (w[k] < 0) w[k] = 0, w /= w.x + w.y + w.z;
    }
    return true;
}

// The runs of inside sections around one shape.
void add_runs(const FacetAndTriangle& pair, const std::vector<Section>& ring, ClippedShapes& result) {
    std::vector<char> keep;
    for (const Section& section : ring) {
        keep.push_back(inside(pair, section));
        result.clean &= !runs_along_border(pair, section);
    }
    const auto first_out = std::find(keep.begin(), keep.end(), 0);
    if (first_out == keep.end()) {
        result.closed.push_back(ring);
        return;
    }
    const std::size_t start = static_cast<std::size_t>(first_out - keep.begin()), n = ring.size();
    std::vector<Section> run;
    const auto finish = [&] {
        if (run.empty()) return;
        result.clean &= move_to_border(run.front().from) && move_to_border(run.back().to);
        result.chains.push_back(std::move(run));
        run.clear();
    };
    for (std::size_t i = 1; i <= n; ++i) {
        const std::size_t at = (start + i) % n;
        if (keep[at])
            run.push_back(ring[at]);
        else
            finish();
    }
    finish();
}

}  // namespace

bool is_level(const Section& section) {
    const double from = section.from.t, to = section.to.t;
    return section.edge == kSlice ||
           std::fabs(to - from) <= kSameLevel * std::max(std::fabs(from), std::fabs(to));
}

ClippedShapes clip_in_scene(const FacetAndTriangle& pair, const std::vector<Shape>& shapes) {
    ClippedShapes result;
    if (shapes.empty()) return result;
    const std::array<std::vector<ImageVertex>, 3> crossings{edge_crossings(pair, 0), edge_crossings(pair, 1),
                                                            edge_crossings(pair, 2)};
    for (const Shape& shape : shapes) {
        std::vector<Section> ring;
        for (std::size_t i = 0; i < shape.size(); ++i) {
            divide(pair, {shape[i].at, shape[(i + 1) % shape.size()].at, shape[i].edge}, crossings, ring);
        }
        add_runs(pair, ring, result);
    }
    return result;
}

}  // namespace trilens
