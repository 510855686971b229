// Which edges of a triangle scene a line drawing shows: borders, creases, changes of material, and
// silhouettes.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/raymesh/triangle_scene.h"

namespace trilens {

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

}  // namespace trilens
