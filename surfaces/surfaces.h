// From cages and primitives to surfaces, and from surfaces to N x N grids.
#pragma once

#include <memory>
#include <string>

#include "base/cage.h"
#include "base/progress.h"
#include "base/surface.h"

namespace trilens {

/// The limit surface of a cage (OpenSubdiv Bfr, double precision): THE door to OpenSubdiv. A surface face is one quad
/// face of the cage, one sub-face of an n-gon under Catmull-Clark or bilinear (n of them, in corner order), or one triangle
/// under Loop; holes have none. `name` is used in messages. Faces that have no limit surface (as
/// non-manifold spots may have) are left out and reported to `warn`.
/// Throws InputError where the cage cannot be used at all: indices out of range, faces of fewer than 3 or more than
/// 255 corners, non-finite points, Loop on faces that are not triangles.
std::unique_ptr<Surface> make_limit_surface(const Cage& cage, const std::string& name, const Warn& warn);

/// The surface of a primitive, exact. Faces: sphere 6 (a cube mapped onto it), cylinder 4 quarters, paraboloid 5
/// (a square and four sides mapped onto its disk), plane 1.
std::unique_ptr<Surface> make_primitive_surface(const Primitive& primitive);

/// n x n squares of two facets per square face, n^2 facets per triangular face. Points on shared edges of faces are
/// one point each (bit for bit); a corner's normal is one where the faces around it agree, and per face
/// along creases. n in 1..1024.
SurfaceGrid make_grid(const Surface& surface, int n);

/// "OpenSubdiv 3.5.0": for `trilens info`.
std::string surface_library_version();

}  // namespace trilens
