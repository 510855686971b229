// The corner rays of whole paths, fitted to the exact rays between them.
#pragma once

#include <span>
#include <vector>

#include "paths/facets/divide_facet.h"
#include "paths/facets/optic_paths.h"

namespace trilens {

/// A projected leaf whose rays are fitted.
struct FittedLeaf {
    Id leaf = kNone;
    const FacetPart* part = nullptr;
};

/// Sets the rays at the corners of these leaves, in every node, to the L2 projection of the exact origins and
/// directions onto the piecewise linear functions of the node's mesh (mathematics, sections 1 and 6),
/// measured on the screen. The exact rays are those at the corners, the edges' middles and the centre, whose
/// rule with weights 1/20, 2/15 and 9/20 integrates cubics (Stroud, Approximate Calculation of Multiple
/// Integrals, 1971, T2: 3-1). Leaves with a corner turned away from the eye take no part, so the fit ends at
/// silhouettes; and it ends where corners are not shared: at creases and boundaries of the grid, at borders
/// of histories.
void fit_nodes(std::span<const FittedLeaf> leaves, std::vector<PathNode>& nodes);

/// The same for a part of a facet by itself, whose corners are its own: what it shows does not pass over into
/// what its neighbours show, by less than the error that it was divided for.
void fit_alone(const FittedLeaf& leaf, std::vector<PathNode>& nodes);

}  // namespace trilens
