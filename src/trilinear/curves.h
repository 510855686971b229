// Images of scene edges: exact conic arcs as rational quadratic Bezier curves (mathematics, section 2), and
// straight pieces as the thesis draws them (Vallance 2005, section 4.5 and chapter 5).
#pragma once

#include <array>
#include <vector>

#include "trilinear/curve_choice.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

// Curved edges by straight pieces, as the thesis draws them: slices and tessellation (Vallance 2005,
// section 4.5).

/// From one t to another, which may be smaller.
struct Stretch {
    double from = 0, to = 0;
};

/// The ends, on one scene edge, of the slices at the levels of t that divide the stretch into `pieces` equal
/// parts, in its order. The thesis divides what lies between the vertices of a whole shape; dividing each
/// edge's own stretch gives both triangles that share the edge the same points, bit for bit, so that no gap
/// opens between them.
std::vector<ImageVertex> slice_ends(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    Stretch stretch, int pieces);

/// A piece of a scene triangle: its corners, and their barycentrics in the whole.
struct TrianglePiece {
    SceneTriangle triangle;
    std::array<Vec3, 3> barycentric;
};

/// The triangle as pieces * pieces congruent ones. Points on an edge that two triangles share come out the
/// same, bit by bit, for both.
std::vector<TrianglePiece> tessellate(const SceneTriangle& triangle, int pieces);

// The image of a piece of a scene edge as exact conic arcs: rational quadratic Bezier curves (mathematics,
// section 2).

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
