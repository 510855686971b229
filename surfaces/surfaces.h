// From cages and primitives to surfaces, and from surfaces to N x N grids.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/description/optic_description.h"
#include "base/math/box.h"
#include "base/raymesh/rational_patch.h"
#include "base/raymesh/surface.h"
#include "base/util/error.h"
#include "surfaces/memory_budget.h"

namespace trilens {

/// The limit surface of a cage (OpenSubdiv Bfr, double precision): THE door to OpenSubdiv. A surface face is
/// one quad face of the cage, one sub-face of an n-gon under Catmull-Clark or bilinear (n of them, in corner
/// order), or one triangle under Loop; holes have none. Without a scheme (kUnsubdivided) it is the cage's
/// triangles with their own normals: see make_polygon_surface. Front is where the face's corners run
/// counter-clockwise.
///
/// `name` is used in messages. `warn` (may be empty) is told of what is repaired or left out: repeated
/// corners, faces that are no simple polygons, creases along no edge, faces that have no limit surface (next
/// to boundaries that are not interpolated).
///
/// Positions are those of infinite subdivision to rounding, but for the last 2^-10 of a face around
/// extraordinary vertices (about 1e-6 of the face there). Where du x dv vanishes (collapsed edges, vertices
/// of two faces), the normal is that of the place a share of 2^-20 (if need be 2^-12, 2^-6) towards the
/// middle of the face.
///
/// Patches are made when a face is first evaluated, and a bounded number of them is kept: bytes_held() grows
/// to no more than what the topology of the cage takes (about 200 bytes per quad after refinement) and 600
/// MB.
///
/// Throws InputError where more than `memory` bytes would be needed while it is made, with the estimate, and
/// where the cage cannot be used at all: no faces, indices out of range, arrays that do not
/// fit together, faces of fewer than 3 or more than 255 corners, non-finite points, negative sharpness, Loop
/// on faces that are not triangles.
std::unique_ptr<Surface> make_limit_surface(const Cage& cage, const std::string& name, const Warn& warn,
                                            double memory = machine_memory());

/// The patches as they are, one face each, over the unit square: in double precision, with exact derivatives.
/// Where sides of neighbours agree (join_patches) they are one edge. Front is where du x dv points.
/// Throws InputError(name) where there are none.
std::unique_ptr<Surface> make_patch_surface(std::vector<RationalPatch> patches, const std::string& name);

/// The surface of a primitive, exact, with intersect(). Faces: sphere 6 (a cube mapped onto it, equal
/// angles), cylinder and cone 4 quarters, paraboloid 5 (a square and four sides mapped onto its disk; no
/// singular point), plane 1. Front is outside of sphere, cylinder and cone, the focus side of the paraboloid,
/// the axis side of the plane.
///
/// axis and tangent need not be exactly unit or at right angles; the sphere's faces follow them too.
/// Throws InputError for sizes that are not positive and for axis and tangent that span no plane.
std::unique_ptr<Surface> make_primitive_surface(const Primitive& primitive);

/// Normals of faces that meet in a point count as one where they differ by at most this (radians): far above
/// what the patches of one smooth surface differ by, far below a visible crease.
inline constexpr double kSameNormal = 1e-3;

/// n x n squares of two facets per square face, n^2 facets per triangular face; n in 1..1024. Facets run
/// counter-clockwise seen from the front; a square is cut along its shorter diagonal.
///
/// Points on shared edges of faces are one point each, bit for bit; a corner's normal is one where the faces
/// around it agree (kSameNormal), and per face along creases.
///
/// No cracks and no T-junctions: an edge between a quad and an n-gon has 2n segments (the n-gon brings two
/// sub-faces to it), and the quad's n squares along it have a fifth corner and three facets.
SurfaceGrid make_grid(const Surface& surface, int n);

/// Per face a box that holds it, told without preparing it; empty where nothing is known of the faces.
std::vector<Box> face_hulls(const Surface& surface);

/// Squares of a face's n x n grid: those from (column, row) on, at most `steps` along either side.
struct GridPart {
    Id face = kNone;
    int column = 0, row = 0, steps = 0;
};

/// The grids of all faces in parts of at most steps x steps squares, face by face; n in 1..1024, steps >= 1.
std::vector<GridPart> grid_parts(const Surface& surface, int n, int steps);

/// The facets that make_grid(surface, n) has there, with points of their own that nothing shares; but squares
/// at split sides have two facets, as all others.
SurfaceGrid make_part_grid(const Surface& surface, int n, const GridPart& part);

/// Per part a box that holds the surface there; empty where the surface has no bounds. Prepares all faces.
std::vector<Box> part_boxes(const Surface& surface, int n, const std::vector<GridPart>& parts);

/// make_grid(surface, n).facets.size(), without the grid; n >= 1.
std::size_t count_facets(const Surface& surface, int n);

/// The largest resolution of 1 .. n whose grid has at most `most_facets`; 1 where none has. n >= 1.
int resolution_within(const Surface& surface, int n, std::size_t most_facets);

/// "OpenSubdiv 3.5.0": for `trilens info`.
std::string surface_library_version();

}  // namespace trilens
