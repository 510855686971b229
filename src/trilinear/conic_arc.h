// The image of a piece of a scene edge as exact conic arcs: rational quadratic Bezier curves (mathematics,
// section 2).
#pragma once

#include <array>
#include <vector>

#include "trilinear/facet/scene_edge.h"

namespace trilens {

/// The arc C(u) = (1 - u)^2 c0 + 2 u (1 - u) c1 + u^2 c2, 0 <= u <= 1, in homogeneous weights: the facet's
/// weights are C / (sum of C's components). The ends' components sum to 1, those of c1 to the Bezier weight,
/// at least kLeastBezierWeight: so the arc lies in the triangle of its control points and turns by less than
/// 150 degrees. Along it t goes from t0 to t1 without turning back.
struct ConicArc {
    std::array<Vec3, 3> control;
    double t0 = 0, t1 = 0;

    Vec3 weights(double u) const;
};

inline constexpr double kLeastBezierWeight = 0.26;

/// The quadratic form of an edge's conic: w . (form w) = 0 for the weights w of rays that meet the line
/// through a and b. Exchanging a and b changes its sign and no other bit.
Mat3 conic_form(const Coplanarity& facet, const Vec3& a, const Vec3& b);

/// The images of the cuts of a triangle's edge at t0 <= t <= t1, t ascending, as arcs joined end to end. The
/// edge must be cut throughout: t0 and t1 lie on one joined piece of a shape. Two triangles that share the
/// edge get the same arcs.
std::vector<ConicArc> edge_arcs(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                double t0, double t1);

/// The arc on the homogeneous screen, for corners at the columns (x w, y w, w): the control points of a
/// rational quadratic Bezier curve, whose Bezier weights are the third components.
std::array<Vec3, 3> on_screen(const ConicArc& arc, const Mat3& screen);

/// The arc's halves about its shoulder, where it is farthest from its chord. The t between is that of the
/// shoulder.
std::array<ConicArc, 2> halves(const ConicArc& arc, const Coplanarity& facet, const Vec3& a, const Vec3& b);

/// How far the arc leaves its chord, in weights.
double sagitta(const ConicArc& arc);

}  // namespace trilens
