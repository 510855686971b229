// Which stretches of t a facet sees of a scene triangle: from the viewing plane t = 0 on (Vallance 2005,
// section 4.6).
#pragma once

#include <vector>

#include "trilinear/shapes.h"

namespace trilens {

/// Windows that together hold every t >= 0 at which a ray with weights in [0, 1] can meet the triangle,
/// ascending. They end a share kCollapseGap before and begin that much after a t at which the parametric
/// triangle collapses (all rays meet in one line or point: a pinhole's t = 0, a focus), where images have no
/// place.
std::vector<Window> view_windows(const Coplanarity& facet, const SceneTriangle& triangle);

/// The parametric triangle has collapsed where its normal is below this share of the terms that it is the sum
/// of.
inline constexpr double kCollapsed = 1e-9;
inline constexpr double kCollapseGap = 1e-6;

}  // namespace trilens
