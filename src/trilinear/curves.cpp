#include "trilinear/outline.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/util/check.h"

namespace trilens {

std::vector<ImageVertex> slice_ends(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    Stretch stretch, int pieces) {
    TRILENS_CHECK(pieces >= 1, "a stretch has at least one piece");
    const double low = std::min(stretch.from, stretch.to), high = std::max(stretch.from, stretch.to);
    std::vector<ImageVertex> ends;
    for (int k = 1; k < pieces; ++k) {
        const double t = low + (high - low) * k / pieces;
        if (!(t > low && t < high)) continue;
        if (const auto end = edge_cut(facet, triangle, edge, t)) ends.push_back(*end);
    }
    if (stretch.from > stretch.to) std::reverse(ends.begin(), ends.end());
    return ends;
}

// Scene triangle tessellation (Vallance 2005, section 4.3).

std::vector<TrianglePiece> tessellate(const SceneTriangle& triangle, int pieces) {
    TRILENS_CHECK(pieces >= 1, "a triangle has at least one piece");
    // Whole-number barycentrics: on an edge one term is zero and the sum of two does not depend on their
    // order.
    const auto at = [&](int i, int j) { return Vec3(pieces - i - j, i, j) / static_cast<double>(pieces); };
    std::vector<TrianglePiece> result;
    const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
        result.push_back({{{triangle.point(a), triangle.point(b), triangle.point(c)}}, {a, b, c}});
    };
    for (int i = 0; i < pieces; ++i) {
        for (int j = 0; i + j < pieces; ++j) {
            add(at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 1 < pieces) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
    }
    return result;
}

// The image of a piece of a scene edge as exact conic arcs, built from two points, the conic and one point
// between. The control point is the pole of the chord (Farin, Curves and Surfaces for CAGD, chapter on
// conics). Nothing here divides by a difference of t: where the edge is parallel to the parametric triangle,
// t tells its points apart by rounding alone.

namespace {

// A tangent that passes the other end at less than this share of the chord is the chord itself.
constexpr double kStraight = 1e-12;

// A conic needs a few arcs, and more only where rounding hides it.
constexpr int kDeepest = 60;
constexpr std::size_t kMostArcs = 200;

// What rounding makes of form's products with weights.
constexpr double kFormRounding = 2e-15;

double size_of(const Mat3& form) {
    return length(form[0]) + length(form[1]) + length(form[2]);
}

double sum(const Vec3& v) {
    return v.x + v.y + v.z;
}

// The part of a line's coefficients that acts on differences of weights (which sum to zero).
double slope(const Vec3& line) {
    return length(line - Vec3(sum(line) / 3));
}

// The arc from p0 over m to p2 on the conic, if it is short enough for one piece.
std::optional<ConicArc> single_arc(const Mat3& form, const Vec3& p0, const Vec3& m, const Vec3& p2) {
    // Tangents at the ends; their common point is the pole of the chord.
    const Vec3 tangent0 = form * p0, tangent2 = form * p2, chord = p2 - p0;
    const double across = 0.5 * (dot(tangent0, p2) + dot(tangent2, p0));
    const double along = dot(m - p0, chord);
    const double straight = kStraight * length(chord) * std::max(slope(tangent0), slope(tangent2));
    const double rounding = kFormRounding * size_of(form) * length(p0) * length(p2);
    if (std::fabs(across) <= straight + rounding) {
        if (along <= 0 || along >= dot(chord, chord)) return std::nullopt;
        return ConicArc{{p0, 0.5 * (p0 + p2), p2}, 0, 0};
    }

    // m = a p0 + b pole + c p2 must lie between the ends: a, c > 0. Then u^2 : 2 u (1 - u) w1 : (1 - u)^2 = c
    // : b : a.
    const double a = dot(tangent2, m) / across, c = dot(tangent0, m) / across;
    if (!(a > 0 && c > 0)) return std::nullopt;
    const double b = -triple(p0, p2, m) / (across * across);
    const Vec3 control = b / (2 * std::sqrt(a * c)) * cross(tangent0, tangent2);
    if (!(sum(control) >= kLeastBezierWeight) || !std::isfinite(sum(control))) return std::nullopt;
    return ConicArc{{p0, control, p2}, 0, 0};
}

// Weights below zero by no more than this are on the border.
constexpr double kTouching = 1e-9;

// How far rounding of a long arc may put its crossing with the border; what is farther along the border is
// another one.
constexpr double kFarthestMove = 1e-6;

struct ArcEnd {
    double t;
    Vec3 weights;
};

// The image of the line through a and b.
class EdgeImage {
  public:
    EdgeImage(const Coplanarity& facet, const Vec3& a, const Vec3& b)
        : facet_(facet), a_(a), along_(b - a), form_(conic_form(facet, a, b)) {}

    // Appends the arcs between two of its points, of which `from` has the smaller t.
    void append(const ArcEnd& from, const ArcEnd& to, int depth, std::vector<ConicArc>& arcs) const {
        const ArcEnd middle = between(from, to);
        std::optional<ConicArc> arc = single_arc(form_, from.weights, middle.weights, to.weights);
        if (!arc && (depth == kDeepest || arcs.size() >= kMostArcs))
            arc = ConicArc{{from.weights, 0.5 * (from.weights + to.weights), to.weights}, 0, 0};
        if (arc) {
            arc->t0 = from.t, arc->t1 = to.t;
            arcs.push_back(*arc);
            return;
        }
        append(from, middle, depth + 1, arcs);
        append(middle, to, depth + 1, arcs);
    }

    // The point of the image on the facet's border `k`, near weights that an arc has there.
    ArcEnd on_border(Vec3 near, int k, const ConicArc& arc) const {
        Vec3 along_border(0);
        along_border[(k + 1) % 3] = 1, along_border[(k + 2) % 3] = -1;
        near[(k + 2) % 3] = 1 - near[(k + 1) % 3], near[k] = 0;
        const std::vector<double> found = crossings(near, along_border);
        const bool is_near = !found.empty() && std::fabs(found[0]) <= kFarthestMove;
        const Vec3 weights = is_near ? near + found[0] * along_border : near;
        return {t_of(weights, arc.t0, arc.t1), weights};
    }

  private:
    // A line across the chord meets the conic in one point of the arc from end to end, which is bounded, and
    // in one of the rest: the arc's is that whose ray touches the edge between the ends' t. The chord is
    // halved as an angle of homogeneous weights, so that of far ends the point is one near the facet.
    ArcEnd between(const ArcEnd& from, const ArcEnd& to) const {
        const Vec3 one = normalize_or_zero(from.weights), other = normalize_or_zero(to.weights),
                   middle = one + other, across = cross(one, other);
        ArcEnd best{0.5 * (from.t + to.t), middle / sum(middle)};
        double least_miss = HUGE_VAL;
        for (const double v : crossings(middle, across)) {
            const Vec3 weights = (middle + v * across) / sum(middle + v * across);
            const double t = t_of(weights, from.t, to.t), miss = miss_of(weights, t);
            if (miss < least_miss) best = {t, weights}, least_miss = miss;
        }
        return best;
    }

    // The v at which start + v way is on the conic, the one nearer zero first; that nearest to the conic
    // where rounding leaves none.
    std::vector<double> crossings(const Vec3& start, const Vec3& way) const {
        const Vec3 by_way = form_ * way;
        const double square = dot(way, by_way), half = dot(start, by_way),
                     constant = dot(start, form_ * start);
        const double far =
            half + std::copysign(std::sqrt(std::max(0.0, half * half - square * constant)), half);
        std::vector<double> found;
        for (const double v : {-constant / far, -far / square})
            if (std::isfinite(v)) found.push_back(v);
        return found;
    }

    // Where the ray passes the edge: closest approach, with the edge's own direction taken out.
    double t_of(const Vec3& weights, double low, double high) const {
        const Vec3 across = without_along(direction(weights));
        const double t = -dot(across, origin(weights)) / dot(across, across);
        return t >= low && t <= high ? t : t > high ? high : low;
    }
    double miss_of(const Vec3& weights, double t) const {
        return length(without_along(origin(weights) + t * direction(weights)));
    }
    Vec3 without_along(const Vec3& v) const { return v - along_ * (dot(v, along_) / dot(along_, along_)); }
    Vec3 origin(const Vec3& w) const { return facet_.origin - a_ + w.y * facet_.e1 + w.z * facet_.e2; }
    Vec3 direction(const Vec3& w) const { return facet_.direction + w.y * facet_.f1 + w.z * facet_.f2; }

    const Coplanarity& facet_;
    Vec3 a_, along_;
    Mat3 form_;
};

EdgeImage image_of(const Coplanarity& facet, const SceneTriangle& triangle, const Section& side) {
    const Vec3 *a = &triangle.from(static_cast<std::size_t>(side.edge)),
               *b = &triangle.to(static_cast<std::size_t>(side.edge));
    return canonically_before(*b, *a) ? EdgeImage(facet, *b, *a) : EdgeImage(facet, *a, *b);
}

// Where an arc crosses border `border` (-1: an end of the arc).
struct ArcCut {
    double u = 0;
    int border = -1;
};

// From 0 to 1, ascending.
std::vector<ArcCut> border_cuts(const ConicArc& arc) {
    const auto& [c0, c1, c2] = arc.control;
    std::vector<ArcCut> cuts{{0, -1}};
    for (int k = 0; k < 3; ++k)
        for (const double u : real_roots({c0[k], 2 * (c1[k] - c0[k]), (c0[k] - c1[k]) + (c2[k] - c1[k]), 0}))
            if (u > 0 && u < 1) cuts.push_back({u, k});
    std::sort(cuts.begin(), cuts.end(),
              [](const ArcCut& a, const ArcCut& b) { return a.u != b.u ? a.u < b.u : a.border < b.border; });
    cuts.push_back({1, -1});
    return cuts;
}

bool is_beyond_border(const ConicArc& arc) {
    const auto& [c0, c1, c2] = arc.control;
    for (int k = 0; k < 3; ++k)
        if (std::max({c0[k], c1[k], c2[k]}) < -kTouching) return true;
    return false;
}

}  // namespace

Vec3 ConicArc::weights(double u) const {
    const Vec3 c = (1 - u) * (1 - u) * control[0] + 2 * u * (1 - u) * control[1] + u * u * control[2];
    return c / sum(c);
}

Mat3 conic_form(const Coplanarity& facet, const Vec3& a, const Vec3& b) {
    if (canonically_before(b, a)) return -conic_form(facet, b, a);
    // l . ((o_l - a) x d_k), the moment of ray k about the edge; symmetric by halves.
    const Vec3 o0 = facet.origin - a, l = b - a;
    const Vec3 o[3] = {o0, o0 + facet.e1, o0 + facet.e2};
    const Vec3 d[3] = {facet.direction, facet.direction + facet.f1, facet.direction + facet.f2};
    Mat3 form;
    for (int j = 0; j < 3; ++j) {
        for (int k = 0; k <= j; ++k) {
            form[j][k] = form[k][j] = 0.5 * (triple(l, o[j], d[k]) + triple(l, o[k], d[j]));
        }
    }
    return form;
}

std::vector<ConicArc> edge_arcs(const Coplanarity& facet, const SceneTriangle& triangle,
                                const Section& side) {
    ArcEnd from{side.from.t, side.from.weights}, to{side.to.t, side.to.weights};
    if (from.t != to.t ? to.t < from.t : canonically_before(to.weights, from.weights)) std::swap(from, to);
    std::vector<ConicArc> arcs;
    image_of(facet, triangle, side).append(from, to, 0, arcs);
    return arcs;
}

std::vector<ConicArc> edge_arcs_inside(const Coplanarity& facet, const SceneTriangle& triangle,
                                       const Section& side) {
    const EdgeImage image = image_of(facet, triangle, side);
    std::vector<ConicArc> inside;
    for (const ConicArc& arc : edge_arcs(facet, triangle, side)) {
        if (is_beyond_border(arc)) continue;
        const std::vector<ArcCut> cuts = border_cuts(arc);
        const auto is_inside = [&](std::size_t i) {
            const Vec3 w = arc.weights(0.5 * (cuts[i].u + cuts[i + 1].u));
            return std::min({w.x, w.y, w.z}) >= -kTouching;
        };
        const auto end_at = [&](const ArcCut& cut) {
            if (cut.border >= 0) return image.on_border(arc.weights(cut.u), cut.border, arc);
            return cut.u == 0 ? ArcEnd{arc.t0, arc.control[0]} : ArcEnd{arc.t1, arc.control[2]};
        };
        for (std::size_t i = 0, next = 0; i + 1 < cuts.size(); i = next) {
            next = i + 1;
            if (!is_inside(i)) continue;
            while (next + 1 < cuts.size() && is_inside(next)) ++next;
            if (cuts[i].border < 0 && cuts[next].border < 0) {
                inside.push_back(arc);
                continue;
            }
            // An arc that meets the facet in one point only has no part in it.
            const ArcEnd from = end_at(cuts[i]), to = end_at(cuts[next]);
            if (length(to.weights - from.weights) > kTouching) image.append(from, to, 0, inside);
        }
    }
    return inside;
}

std::array<Vec3, 3> on_screen(const ConicArc& arc, const Mat3& screen) {
    return {screen * arc.control[0], screen * arc.control[1], screen * arc.control[2]};
}

std::array<ConicArc, 2> halves(const ConicArc& arc, const Coplanarity& facet, const Vec3& a, const Vec3& b) {
    // De Casteljau at u = 1/2, with the shoulder's weight brought back to 1.
    const auto& [c0, c1, c2] = arc.control;
    const double half = 0.5 * (1 + sum(c1));
    const Vec3 shoulder = (c0 + 2.0 * c1 + c2) / (4 * half);
    const Vec3 left = 0.5 * (c0 + c1) / std::sqrt(half), right = 0.5 * (c1 + c2) / std::sqrt(half);

    // The ray of the shoulder passes the edge at this t: closest approach, with the edge's own direction
    // taken out.
    const Vec3 l = b - a;
    const Vec3 origin = facet.origin - a + shoulder.y * facet.e1 + shoulder.z * facet.e2;
    const Vec3 direction = facet.direction + shoulder.y * facet.f1 + shoulder.z * facet.f2;
    const Vec3 across = direction - l * (dot(direction, l) / dot(l, l));
    const double t = -dot(across, origin) / dot(across, direction);
    const double between = t > arc.t0 && t < arc.t1 ? t : 0.5 * (arc.t0 + arc.t1);
    return {ConicArc{{c0, left, shoulder}, arc.t0, between},
            ConicArc{{shoulder, right, c2}, between, arc.t1}};
}

double sagitta(const ConicArc& arc) {
    // The shoulder's tangent is parallel to the chord, so that no point is farther from the chord's line.
    // Beyond the chord's ends the arc reaches at most as far as this share of the way to the control point.
    const auto& [c0, c1, c2] = arc.control;
    const double w = sum(c1);
    const Vec3 chord = c2 - c0, shoulder = (c0 + 2.0 * c1 + c2) / (2 * (1 + w)) - c0, pole = c1 / w - c0;
    const double length2 = dot(chord, chord);
    if (length2 == 0) return length(shoulder);
    const double beyond = std::max({0.0, -dot(pole, chord), dot(pole, chord) - length2}) / std::sqrt(length2);
    return length(cross(chord, shoulder)) / std::sqrt(length2) + beyond * w / (1 + w);
}

}  // namespace trilens
