// A polygon mesh as files give it, in its own frame, and what becomes of it: a placed cage or an object's
// triangles.
#pragma once

#include <cstddef>
#include <vector>

#include "base/description/cage.h"
#include "base/description/material.h"
#include "base/util/ids.h"
#include "scene/data/scene.h"
#include "scene/data/transform.h"

namespace trilens {

/// Cage fields with what only objects need. Indices are in range.
struct PolygonMesh {
    Cage cage;
    // Per face corner, parallel to cage.face_vertex_indices; empty where the file has none.
    std::vector<Vec2> uvs;            // v upward
    std::vector<Vec3> normals;        // any length; zero: none, take the triangle's own
    std::vector<Id> face_material;    // per face an index into `materials`, or kNone; empty: none at all
    std::vector<Material> materials;  // the file's own
};

/// Moves points and normals; a mirroring transform also reverses the corners of each face after the first, so
/// that fronts stay fronts. Returns false where a point leaves the range of coordinates.
bool place(PolygonMesh& mesh, const Transform& transform);

/// The triangles of polygons, with what could not be cut right.
struct TriangulatedMesh {
    ObjectMesh object;
    std::size_t uncovered_faces = 0;  // drawn as fans that do not cover them: they cross themselves
};

/// n - 2 triangles for each polygon of n corners (see triangulate_polygon), in face order, holes left out;
/// degenerate triangles stay. `material` of the object holds indices of `mesh.materials` or kNone, one per
/// triangle.
TriangulatedMesh triangulate(const PolygonMesh& mesh);

/// Per triangle: whether its area is zero (relative to its longest edge squared, kNoArea) .
std::size_t count_without_area(const ObjectMesh& mesh);
inline constexpr double kNoArea = 1e-14;

/// Doubtful spots of a cage's topology.
struct CageDiagnostics {
    std::size_t boundary_edges = 0;      // with one face
    std::size_t non_manifold_edges = 0;  // with more than two faces, or two that disagree on its direction
    std::size_t repeated_corners = 0;    // faces that visit a point twice
    std::size_t unknown_creases = 0;     // crease pairs that are no edge
    std::size_t flat_faces = 0;          // faces without area
};
CageDiagnostics diagnose_cage(const Cage& cage);

}  // namespace trilens
