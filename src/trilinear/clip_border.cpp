// Pieces of outlines closed along a facet's border, and polygons cut at it (Vallance 2005, section 5.1).
#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "trilinear/clip.h"

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

}  // namespace trilens
