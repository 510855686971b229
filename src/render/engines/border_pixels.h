// Pixels on the borders between facets of one mesh: facets that cover them together. By the degree of a map:
// where no border of a patch of facets lies in a pixel, the patch covers all of it as often as any point of
// it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/surface.h"
#include "projector/projector.h"

namespace trilens {

/// What the samples of a pixel see of a surface's grid: `facets`, that share edges and one face of the
/// surface, and nothing else.
struct JointFacets {
    Visible seen;  // the first of them, and bounds of t for all
    std::vector<Id> facets;
};

/// `candidates`: of one pixel, all facets that its samples may see. `corner`: the rays of its outermost
/// samples; their place on the film is linear in their directions and origins, as of linear cameras. None
/// where samples may see other facets, or none.
std::optional<JointFacets> joint_facets(const SurfaceGrid& grid, std::span<const PixelTriangle> candidates,
                                        const std::array<Ray, 4>& corner);

}  // namespace trilens
