// Caustics: the surfaces in the world on which neighbouring rays of a RayMesh meet.
#pragma once

#include <array>
#include <vector>

#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// One sheet of the caustic of a RayMesh's rays, world frame. Each ray touches the caustic at up to two
/// places, the roots of the characteristic equation of the rays around it (camera/model/ray_spread.h); the
/// first sheet is the one that follows the ray's start when its roots are counted on through infinity: it has
/// the larger 1 / t.
struct CausticSheet {
    int sheet = 0;            // 0 or 1
    bool is_virtual = false;  // behind the rays' starts (t < 0): where their lines meet, not they themselves
    std::vector<Vec3> points;
    std::vector<IdTriple> triangles;          // of facets whose image on the sheet has an area
    std::vector<std::array<Id, 2>> segments;  // of those that it makes thin, as on a camera's slits
};

struct CausticParams {
    const RayMesh& mesh;
    std::vector<char> seen;  // per facet: whether it takes part; empty: all do
    double size = 1;         // of the scene, world units: places farther than kFarCaustic of it are left out
};
inline constexpr double kFarCaustic = 10;

/// The sheets that are not empty: a point for each corner that has a root, found with the rays' derivatives
/// at the corners (ray_slopes.h), so of second order in the facets' size inside of the mesh and of first at
/// its border. Complex roots that rounding or the facets' size may have made of a double one (by a thousandth
/// of the equation's own terms) count as that. Rays are followed through whatever stands before the caustic.
/// Throws InputError where `mesh` or `seen` do not fit together.
std::vector<CausticSheet> caustic_sheets(const CausticParams& params);

}  // namespace trilens
