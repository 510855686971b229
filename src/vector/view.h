// The edges of a scene as one RayMesh shows them: exact conic arcs on the screen, cut to what is visible.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"
#include "vector/edges.h"

namespace trilens {

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

}  // namespace trilens
