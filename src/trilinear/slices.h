// Parametric triangle slices: curved edges by points at further levels of t (Vallance 2005, section 4.5.2).
#pragma once

#include <vector>

#include "trilinear/scene_edge.h"

namespace trilens {

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

}  // namespace trilens
