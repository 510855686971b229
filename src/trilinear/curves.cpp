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
// conics).

namespace {

// A tangent that passes the other end at less than this share of the chord is the chord itself.
constexpr double kStraight = 1e-12;

// Halving a stretch of t that often reaches neighbouring doubles; a conic needs a few arcs, and more only
// where rounding hides it.
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

struct EdgeImage {
    const Coplanarity& facet;
    const Vec3 &a, &b;
    Mat3 form;

    std::optional<Vec3> at(double t) const {
        return weights_in_parametric_triangle(facet, t, cut_edge(facet, t, a, b).point);
    }

    void append(double t0, const Vec3& p0, double t1, const Vec3& p1, int depth,
                std::vector<ConicArc>& arcs) const {
        const double middle = 0.5 * (t0 + t1);
        const std::optional<Vec3> m = at(middle);
        std::optional<ConicArc> arc;
        if (m) arc = single_arc(form, p0, *m, p1);
        if (!arc && (depth == kDeepest || arcs.size() >= kMostArcs || !m || middle <= t0 || middle >= t1)) {
            arc = ConicArc{{p0, 0.5 * (p0 + p1), p1}, 0, 0};
        }
        if (arc) {
            arc->t0 = t0, arc->t1 = t1;
            arcs.push_back(*arc);
            return;
        }
        append(t0, p0, middle, *m, depth + 1, arcs);
        append(middle, *m, t1, p1, depth + 1, arcs);
    }
};

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

std::vector<ConicArc> edge_arcs(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                double t0, double t1) {
    const Vec3 *a = &triangle.from(edge), *b = &triangle.to(edge);
    if (canonically_before(*b, *a)) std::swap(a, b);
    const EdgeImage image{facet, *a, *b, conic_form(facet, *a, *b)};
    const std::optional<Vec3> p0 = image.at(t0), p1 = image.at(t1);
    std::vector<ConicArc> arcs;
    if (p0 && p1) image.append(t0, *p0, t1, *p1, 0, arcs);
    return arcs;
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
