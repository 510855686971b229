// Views through facets: the exact projector, and Embree on the rays of the same facets.
#pragma once

#include "cli/camera_rays.h"
#include "cli/views.h"

namespace trilens {

/// A viewer that replaces every optic by its N x N grid. `engine`: kExact or kFacetsTruth.
/// Throws InputError where the optics have too many facets to hold.
Viewer make_facet_viewer(const World& world, CameraRays camera, Engine engine, const Warn& warn);

}  // namespace trilens
