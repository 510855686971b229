// The image of a scene triangle in a facet: its shapes, the conics of their edges, both cut at the facet's
// border, and closed as outlines (Vallance 2005, chapters 4 and 5).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "base/math/roots.h"
#include "trilinear/curve_choice.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

// The shapes of a scene triangle in a facet: its projected vertices, joined (Vallance 2005, chapter 4,
// table 4.1), from the viewing plane t = 0 on (section 4.6).

/// A stretch of t in which shapes are looked for.
struct Window {
    double begin = -kFarthestRoot, end = kFarthestRoot;
};

inline constexpr int kSlice = 3;  // beside the edges 0, 1, 2: along a slice, straight in weights

/// A corner of a shape.
struct ShapeVertex {
    ImageVertex at;
    int corner = -1;  // the scene vertex that is imaged here; -1: an edge is cut by the window's begin or end
    int edge = 0;     // what runs from here to the next vertex: the image of scene edge 0, 1 or 2, or kSlice
};

/// One connected piece of the triangle's image: a closed outline, the last vertex joined to the first. A
/// shape's inside is imaged once, and shapes do not overlap: a ray meets the triangle's plane in one point.
using Shape = std::vector<ShapeVertex>;

/// The real roots of the scene vertices' cubics: where each is imaged (section 4.1, project_vertices).
std::array<RealRoots, 3> project_vertices(const Coplanarity& facet, const SceneTriangle& triangle);

/// All shapes whose t lies in the window, over the whole plane of weights; over all t there are one to four
/// of two to nine vertices. The rule (section 4.3): along each scene edge the roots of both ends, merged and
/// sorted by t, are joined first to second, third to fourth, and so on; where the edge is cut at the window's
/// begin, that cut comes first. Where the window ends, a slice closes the outline. Left out are shapes with a
/// vertex where the parametric triangle is degenerate: let the window end before (view_windows).
std::vector<Shape> make_shapes(const Coplanarity& facet, const SceneTriangle& triangle,
                               const Window& window = {});

// Which stretches of t a facet sees of a scene triangle: from the viewing plane t = 0 on (Vallance 2005,
// section 4.6).

/// Windows that together hold every t >= 0 at which a ray with weights in [0, 1] can meet the triangle,
/// ascending. They end a share kCollapseGap before and begin that much after a t at which the parametric
/// triangle collapses (all rays meet in one line or point: a pinhole's t = 0, a focus), where images have no
/// place.
std::vector<Window> view_windows(const Coplanarity& facet, const SceneTriangle& triangle);

/// The parametric triangle has collapsed where its normal is below this share of the terms that it is the sum
/// of.
inline constexpr double kCollapsed = 1e-9;
inline constexpr double kCollapseGap = 1e-6;

/// A part of a shape's border: from one vertex to another, along a scene edge or (kSlice) straight.
struct Section {
    ImageVertex from, to;
    int edge = kSlice;
};

/// Whether the section lies in one slice: its image is straight, and t does not tell its points apart. So
/// does the image of a scene edge that is parallel to the parametric triangle: its two ends have one root, up
/// to rounding.
bool is_level(const Section& section);

// Images of scene edges: exact conic arcs as rational quadratic Bezier curves (mathematics, section 2), and
// straight pieces as the thesis draws them (Vallance 2005, section 4.5 and chapter 5).

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

/// The image of a piece of a triangle's edge as arcs joined end to end, t ascending. The ends lie on one
/// joined piece of a shape, and are the arcs' own ends: their weights place the arcs, and their t, which may
/// be equal or differ by rounding alone (an edge parallel to the parametric triangle), only chooses between
/// the two ways around the conic. Two triangles that share the edge get the same arcs. `side.edge` is no
/// slice.
std::vector<ConicArc> edge_arcs(const Coplanarity& facet, const SceneTriangle& triangle, const Section& side);

/// The parts of these arcs whose weights are all >= 0 up to rounding: cut where the arcs themselves cross the
/// facet's border, so that no t decides. What runs along the border is inside.
std::vector<ConicArc> edge_arcs_inside(const Coplanarity& facet, const SceneTriangle& triangle,
                                       const Section& side);

/// The arc on the homogeneous screen, for corners at the columns (x w, y w, w): the control points of a
/// rational quadratic Bezier curve, whose Bezier weights are the third components.
std::array<Vec3, 3> on_screen(const ConicArc& arc, const Mat3& screen);

/// The arc's halves about its shoulder, where it is farthest from its chord. The t between is that of the
/// shoulder.
std::array<ConicArc, 2> halves(const ConicArc& arc, const Coplanarity& facet, const Vec3& a, const Vec3& b);

/// How far the arc leaves its chord, in weights.
double sagitta(const ConicArc& arc);

// Outlines cut at a facet's border: on the screen, and in the scene (Vallance 2005, chapter 5).

/// A facet and a scene triangle, with what the facet precalculates.
struct FacetAndTriangle {
    const TrilinearFacet& facet;
    const Coplanarity& cubic;
    const SceneTriangle& triangle;
};

/// The part of each shape whose weights are all >= 0. A section is a piece of a shape's border between two
/// neighbours among its vertices and the points where it crosses the facet's borders; these crossings are
/// computed in the scene (edge_sweep), those of level sections between their ends.
struct ClippedShapes {
    std::vector<std::vector<Section>> closed;  // shapes wholly inside
    std::vector<std::vector<Section>> chains;  // from border to border
    bool clean = true;  // false: a chain's end is not on the border, or a section runs along it: touching
                        // cases, which rounding confuses
};

ClippedShapes clip_in_scene(const FacetAndTriangle& pair, const std::vector<Shape>& shapes);

/// A closed polygon in the facet's weights, the last vertex joined to the first. Between its vertices t and
/// the barycentrics are not linear: t = n . (a - o) / (n . d) for the triangle's plane.
struct Outline {
    std::vector<ImageVertex> vertex;
};

/// A polyline whose two ends lie on the facet's border (one weight exactly 0).
using Chain = std::vector<ImageVertex>;

/// Closes chains along the facet's border, corners included, so that the border between two neighbouring ends
/// is taken where its rays meet the triangle. Without chains: the whole border, if its rays meet the
/// triangle.
std::vector<Outline> join_along_border(const FacetAndTriangle& pair, const std::vector<Chain>& chains);

/// Cuts polygons at the facet's three edges; the inside is by the even-odd rule over all of them.
std::vector<Outline> clip_on_screen(const FacetAndTriangle& pair, std::vector<Outline> outlines);

// The image of a scene triangle in a facet as closed outlines: what a scanline filler or a drawing needs.

struct ShapeParams {
    Curves curves = Curves::kArcs;
    Clip clip = Clip::kScene;
    int pieces = 8;           // kSlices, kTessellate: at least 1
    double tolerance = 1e-3;  // kArcs: how far a polygon may leave its curve, in weights; kUnclipped: away
                              // from the facet times the distance
};

/// The image with t >= 0. A weight belongs to it where an odd number of outlines holds it (even-odd rule over
/// all outlines of one call; with kTessellate over each piece). Outlines are in no particular orientation.
/// With a clip every vertex has weights >= 0, and vertices on the facet's border have a weight of exactly 0;
/// with kUnclipped outlines far from the facet end where t leaves view_windows. kArcs with any clip is exact
/// up to `tolerance`; the other ways approach it as `pieces` grows.
std::vector<Outline> project_triangle(const TrilinearFacet& facet, const SceneTriangle& triangle,
                                      const ShapeParams& params = {});

/// Whether the facet may image the triangle: a fast, conservative answer.
bool may_image(const TrilinearFacet& facet, const SceneTriangle& triangle);

/// Where the ray of the given weights meets the triangle's plane, for any t; none where it runs along it.
std::optional<ImageVertex> plane_hit(const TrilinearFacet& facet, const SceneTriangle& triangle,
                                     const Vec3& weights);

}  // namespace trilens
