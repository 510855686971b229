// Shapes cut where scene edges cross the surfaces that the facet's edges sweep (Vallance 2005, section 5.2).
#include <algorithm>
#include <cmath>

#include "trilinear/clip.h"
#include "trilinear/edge_sweep.h"

namespace trilens {
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
