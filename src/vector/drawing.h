// The edges of a scene that a line drawing shows (borders, creases, changes of material, silhouettes), as one
// RayMesh shows them: exact conic arcs on the screen, cut to what is visible.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "base/raymesh/triangle_scene.h"
#include "render/frame/frame.h"
#include "render/marks/marks.h"
#include "vector/caustic.h"
#include "vector/lines.h"

namespace trilens {

// Which edges of a triangle scene a line drawing shows: borders, creases, changes of material, and
// silhouettes.

/// An edge of a scene triangle, listed once for all triangles that share it.
struct DrawnEdge {
    Id triangle = kNone;
    std::size_t edge = 0;  // from the triangle's corner `edge` to the next
    Id other = kNone;      // the triangle on the other side, where there is exactly one
    bool always = true;    // false: drawn only where it is a silhouette
    bool same_winding =
        true;  // of `triangle` and `other`: their normals point to the same side of the surface
};

/// Edges with what a drawing asks of them.
struct DrawnEdges {
    std::vector<DrawnEdge> edge;
    std::vector<std::array<Id, 3>> vertex_of;  // per triangle: its corners, those at the same place being one
    std::vector<std::size_t> first_of;  // per vertex and one more: where its edges begin in `of_vertex`
    std::vector<Id> of_vertex;          // indices into `edge`
    std::vector<Vec3> normal;           // per triangle, not unit
    std::vector<std::array<Id, 3>>
        neighbour;  // per triangle and edge: the other triangle there, kNone where there is not exactly one

    std::span<const Id> at(Id vertex) const {
        return {of_vertex.data() + first_of[vertex], first_of[vertex + 1] - first_of[vertex]};
    }
};

/// Faces that meet at more than this angle (degrees) make a crease.
inline constexpr double kCreaseAngle = 25;

struct EdgeRules {
    std::span<const Id> material;       // per triangle; an edge between two materials is drawn
    std::size_t without_creases = ~0u;  // triangles from this one on belong to smooth surfaces: no creases
};

/// Edges join inside one object, where their ends have equal coordinates. An edge of one triangle is a
/// border; one of three or more is always drawn; diagonals of flat faces are left out.
DrawnEdges drawn_edges(const TriangleScene& scene, const EdgeRules& rules);

/// Whether a ray of this direction sees the edge as a silhouette: one of its two triangles from the front,
/// one from the back.
bool is_silhouette(const DrawnEdges& edges, const DrawnEdge& edge, const Vec3& direction);

// The edges of a scene as one RayMesh shows them: exact conic arcs on the screen, cut to what is visible.

/// A rational quadratic Bezier curve: control points (x w, y w, w), w > 0, x and y in pixels from the film's
/// top left.
using ScreenArc = std::array<Vec3, 3>;

/// A piece of an edge's image in one facet: arcs joined end to end.
struct EdgeCurve {
    Id triangle = kNone;  // of the scene
    Id facet = kNone;     // of the mesh
    std::vector<ScreenArc> arcs;
};

/// What the exact engine found at each sample of `grid`, and what looks.
struct VectorView {
    const TriangleScene& scene;
    const DrawnEdges& edges;
    const RayMesh& mesh;
    const SampleGrid& grid;        // the whole film
    std::span<const Id> facet;     // per sample: the facet of the mesh that it shows, or kNone
    std::span<const Id> triangle;  // per sample: the triangle of the scene seen there, or kNone
    bool wire = false;             // hidden edges too
};

/// Curves in facets that own samples, by ascending facet; cut where they leave their facet or the film.
/// Without `wire` an arc's piece is kept where one of the four samples around it shows a triangle of the
/// edge, or nothing that would lie before the edge if it reached there; so ends of visible pieces are right
/// to about a sample, and an edge all of whose neighbourhood is thinner than a sample may be lost. Between
/// such pieces it is also kept where it stays beside what is seen of its own triangles, a sample away: an
/// edge that stands a hair inside a floor is no dashed line. The same for any number of threads.
std::vector<EdgeCurve> edge_curves(const VectorView& view);

/// The piece u0 <= u <= u1 of an arc.
ScreenArc piece_of(const ScreenArc& arc, double u0, double u1);

/// The arc's point in pixels.
Vec2 point_of(const ScreenArc& arc, double u);

/// The curve as points in pixels: straight lines between them are within `tolerance` pixels of its arcs.
std::vector<Vec2> polyline_of(const EdgeCurve& curve, double tolerance);

// A picture as lines: the outlines of what the camera and its optics show.

/// The curves of one path of light.
struct DrawingLayer {
    std::string path;                      // "direct", "reflect", "refract"
    Id optic = kNone;                      // object id of the optic that shows them; kNone for "direct"
    const TriangleScene* scene = nullptr;  // of the curves' triangles
    std::vector<EdgeCurve> curves;
    std::vector<FoldCurve> folds;
    std::vector<CausticSheet> caustic;
};

struct Drawing {
    int width = 0, height = 0;
    LineChoice lines;
    TriangleScene visible;  // objects, then the optics' facets: what "direct" shows
    std::vector<std::unique_ptr<DrawingLayer>> layers;
    std::vector<FacetEdge> facet_edges;
    PlacedMarks marks;  // the scene's points and labels
};

/// Draws what the exact engine shows over each pixel's principal paths; one layer for each history. `warn` is
/// told of what is traced and so has no lines. The world must outlive the drawing. Throws as make_frame does.
std::unique_ptr<Drawing> make_drawing(const World& world, const FrameParams& frame, const LineChoice& lines,
                                      const Warn& warn);

/// How far, in pixels, the Bezier curves of the SVG may leave the exact conics.
inline constexpr double kSvgTolerance = 0.01;

/// The drawing as an SVG document: one path per curve, its cubic Bezier curves within kSvgTolerance of the
/// conics. The exact arcs stand in its attribute data-conic: "x0 y0 x1 y1 x2 y2 w" for each, a rational
/// quadratic Bezier curve with Bezier weights 1, w, 1.
std::string drawing_svg(const Drawing& drawing, const World& world);

/// The marks as a group of ellipses and texts, from far to near; empty where there are none. A splat's colour
/// is its light's, as sRGB, not mixed with what else comes its way.
std::string marks_svg(const PlacedMarks& marks, const World& world);

/// A text between tags or quotes.
std::string svg_text(const std::string& text);

/// The caustics as triangles, and the fold curves where they lie on objects as lines, in a Wavefront OBJ,
/// world frame: an object for each sheet and each curve, "OPTIC-PATH-first", "-second", with "-virtual"
/// behind the optic, "OPTIC-PATH-fold-on-OBJECT"; the camera's own begin with "camera".
std::string drawing_obj(const Drawing& drawing, const World& world);

}  // namespace trilens
