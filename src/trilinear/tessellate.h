// Scene triangle tessellation: curved edges by smaller triangles (Vallance 2005, section 4.5.1).
#pragma once

#include <vector>

#include "trilinear/scene_edge.h"

namespace trilens {

/// A piece of a scene triangle: its corners, and their barycentrics in the whole.
struct TrianglePiece {
    SceneTriangle triangle;
    std::array<Vec3, 3> barycentric;
};

/// The triangle as pieces * pieces congruent ones. Points on an edge that two triangles share come out the
/// same, bit by bit, for both.
std::vector<TrianglePiece> tessellate(const SceneTriangle& triangle, int pieces);

}  // namespace trilens
