// A proof that there is one path of light near another: Krawczyk's operator on all parameters of a chain
// (Neumaier, Interval Methods for Systems of Equations, chapter 5).
#pragma once

#include <vector>

#include "base/raymesh/surface.h"
#include "specular/chain/path_chain.h"

namespace trilens {

/// For each event of a chain a box of its surface's parameters, and what that does over it.
struct ChainBox {
    std::vector<SurfaceBounds> bounds;
    std::vector<Vec2> half;  // of the boxes' sides, > 0
};

/// How much each entry of chain_second_derivatives() changes over the boxes at most, from their middles: a
/// full matrix, row by row; empty where a stretch of the path may have no length.
std::vector<double> second_derivative_radii(const PathChain& chain, const ChainBox& box);

/// Whether it is proven that exactly one path of light between the chain's ends meets its surfaces within
/// these boxes, with each event on the sides that its kind says. False says nothing. Sound for surfaces whose
/// normals are their own, up to the bounds of these; rounding is allowed for.
bool holds_one_path(const PathChain& chain, const ChainBox& box);

}  // namespace trilens
