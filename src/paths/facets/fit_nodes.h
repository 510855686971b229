// Piecewise linear functions on a triangle mesh that come nearest to given values: the L2 projection.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"
#include "paths/facets/divide_facet.h"
#include "paths/facets/optic_paths.h"

namespace trilens {

/// Several functions at once: the origin and the direction of a ray, and how far the next optic is.
inline constexpr std::size_t kFitParts = 7;
using FitValue = std::array<double, kFitParts>;

/// What the functions should be at one point of a facet.
struct FitSample {
    IdTriple corners;
    Vec3 weights{0};     // of the corners: not negative, sum 1
    double measure = 0;  // how much of the screen it speaks for, > 0
    FitValue value{};
};

/// Divides the measure of each facet's samples, which stand side by side, by how far the values as they are
/// miss them (root of the mean square, in parts of the direction's length). The sum below is then one of
/// errors, no longer of their squares: a facet in which rays turn much, beside a crease or at a silhouette,
/// does not draw its neighbours' corners away from what they ask. Flat mirrors stay exact. A direction of
/// length 1 is `unit` of the scene's lengths long: parallel rays' directions are no lengths themselves.
void even_out(std::span<FitSample> samples, std::span<const FitValue> values, double unit);

/// Sets the values at corners so that the sum over samples of measure * |interpolated - value|^2 is least.
/// Values that are exact already stay as they are; corners that no sample names keep theirs, and where the
/// samples leave a choice they stay near theirs. The same bytes for any number of threads.
///
/// The normal equations have the mesh's mass matrix. Over its row sums its eigenvalues lie within (0, 1], for
/// facets of even measure within [1/4, 1] on any mesh (Wathen, Realistic eigenvalue bounds for the Galerkin
/// mass matrix, 1987), so Chebyshev's iteration gains a factor of 2.6 with each step, without inner
/// products (Wathen and Rees, Chebyshev semi-iteration in preconditioning for problems including the mass
/// matrix, 2009).
void fit_linear(std::span<const FitSample> samples, std::span<FitValue> values);

// The corner rays of whole paths, fitted to the exact rays between them.

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
/// of histories. `unit`: as even_out has it.
void fit_nodes(std::span<const FittedLeaf> leaves, std::vector<PathNode>& nodes, double unit);

/// The same for a part of a facet by itself, whose corners are its own: what it shows does not pass over into
/// what its neighbours show, by less than the error that it was divided for.
void fit_alone(const FittedLeaf& leaf, std::vector<PathNode>& nodes);

}  // namespace trilens
