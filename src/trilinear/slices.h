// Parametric triangle slices: curved edges by points at further levels of t (Vallance 2005, section 4.4).
#pragma once

#include <vector>

#include "trilinear/shapes.h"

namespace trilens {

/// Levels of t that divide each stretch between neighbouring vertices of a shape into `pieces` equal parts,
/// ascending; the vertices' own t are not among them.
std::vector<double> slice_levels(const Shape& shape, int pieces);

/// From one t to another, which may be smaller.
struct Stretch {
    double from = 0, to = 0;
};

/// The ends, on one scene edge, of the slices at those levels that lie inside the stretch, in its order.
std::vector<ImageVertex> slice_ends(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    const std::vector<double>& levels, Stretch stretch);

}  // namespace trilens
