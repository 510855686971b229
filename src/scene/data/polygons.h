// A polygon mesh as files give it, in its own frame, its affine maps, and what becomes of it: a placed cage
// or an object's triangles, by ear clipping.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/description/material.h"
#include "base/description/optic_description.h"
#include "base/math/vec.h"
#include "base/util/ids.h"
#include "scene/data/scene.h"

namespace trilens {

// Affine maps of meshes: what a scene file's `transform` and a glTF node say.

/// point -> linear * point + translation.
struct Transform {
    Mat3 linear{1};
    Vec3 translation{0};
};

inline Vec3 map_point(const Transform& t, const Vec3& point) {
    return t.linear * point + t.translation;
}

/// First `inner`, then `outer`.
Transform compose(const Transform& outer, const Transform& inner);

/// Scale, then rotate, then translate. The quaternion x, y, z, w may have any length but 0.
Transform make_transform(const Vec3& translate, const Vec4& rotate, const Vec3& scale);

/// The quaternion x, y, z, w of a rotation by `degrees` about an axis of any length but 0.
Vec4 quaternion_about(const Vec3& axis, double degrees);

/// Of rotations about the fixed axes by `degrees` about x, y and z, in the order of the letters: "XYZ" is
/// about x first.
Vec4 quaternion_of_euler(const Vec3& degrees, const std::string& order);

/// From 16 numbers, column by column; none where the last row is not 0 0 0 1.
std::optional<Transform> make_transform(std::span<const double, 16> columns);

/// Whether the map turns volumes to nothing: |det| <= kFlat times the product of its columns' lengths.
bool flattens(const Transform& t);
inline constexpr double kFlat = 1e-12;

/// Whether the map turns right hands into left hands.
bool mirrors(const Transform& t);

/// Normals go by the inverse transpose; unit, or zero where the normal is zero. `t` must not flatten.
Mat3 normal_map(const Transform& t);

/// A tangent of a normal map: unit, and in w its handedness, which a mirroring map turns over.
Vec4 map_tangent(const Transform& t, const Vec4& tangent);

/// The factor of a similarity (rotation or mirroring times a factor), none for other maps. Tolerance:
/// kSimilar.
std::optional<double> similarity_factor(const Transform& t);
inline constexpr double kSimilar = 1e-9;  // relative; a matrix written with ten digits passes

// A polygon mesh as files give it, in its own frame, and what becomes of it: a placed cage or an object's
// triangles, by ear clipping.

/// Heights over a mesh by its uv: `offset` + `scale` times the luminance of a picture of numbers.
struct HeightMap {
    PlacedTexture texture;  // without a picture there are no heights
    double scale = 1, offset = 0;
};

/// Cage fields with what only objects need. Indices are in range.
struct PolygonMesh {
    Cage cage;
    // Per face corner, parallel to cage.face_vertex_indices; empty where the file has none.
    std::vector<Vec2> uvs;            // v upward
    std::vector<Vec2> second_uvs;     // of textures that ask for the second set
    std::vector<Vec4> colors;         // factors of the base colour and its alpha, not negative
    std::vector<Vec3> normals;        // any length; zero: none, take the triangle's own
    std::vector<Vec4> tangents;       // as ObjectMesh has them, any length; zero: none
    std::vector<Id> face_material;    // per face an index into `materials`, or kNone; empty: none at all
    std::vector<Material> materials;  // the file's own
    std::vector<HeightMap> heights;   // of materials that move the mesh's points, one per entry; or empty
    bool is_triangle_soup = false;    // a point may stand there several times, as in glTF
};

/// Moves points. Returns false where one leaves the range of coordinates.
bool place(std::vector<Vec3>& points, const Transform& transform);

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

/// Whether the triangle's area is zero, relative to its longest edge squared (kNoArea).
bool lacks_area(const std::vector<Vec3>& points, const IdTriple& triangle);
/// How many of the mesh's triangles have none.
std::size_t count_without_area(const ObjectMesh& mesh);
inline constexpr double kNoArea = 1e-14;

/// Doubtful spots of a cage's topology.
struct CageDiagnostics {
    std::size_t boundary_edges = 0;      // with one face
    std::size_t non_manifold_edges = 0;  // with more than two faces, or two that disagree on its direction
    std::size_t repeated_corners = 0;    // faces that visit a point twice
    std::size_t unknown_creases = 0;     // crease pairs that are no edge
    std::size_t flat_faces = 0;          // faces without area
    bool is_inside_out = false;          // it bounds a body, whose inside the fronts of its faces look into
};
CageDiagnostics diagnose_cage(const Cage& cage);

/// Of the body that the faces bound, as fans: positive where their fronts are outside (divergence theorem).
/// Of a cage whose edges have two faces each, of opposite direction; its points in world units.
double signed_volume(const Cage& cage);

// A polygon in space cut into triangles between its corners.

/// The n - 2 triangles of a polygon of n corners, as indices of its corners, wound as it is.
struct PolygonTriangles {
    std::vector<std::array<std::size_t, 3>> triangles;
    bool covers = true;  // false: no cut covers the polygon, and the triangles are its fan
};

/// Cuts a polygon of at least 3 corners with finite coordinates up to 1e30. Seen along Newell's normal, where
/// the triangles of the fan from corner 0 all keep the polygon's winding (so always where it is convex), they
/// are the answer; otherwise ears are clipped, the first from corner 0 on. A polygon that crosses itself, and
/// one without a plane, may have no such cut: then it is the fan, and `covers` is false. Corners are compared
/// on a grid of 2^-30 of the polygon's extent. Based on: Meisters, Polygons Have Ears (1975).
PolygonTriangles triangulate_polygon(std::span<const Vec3> corners);

}  // namespace trilens
