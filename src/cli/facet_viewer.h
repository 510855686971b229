// Views through facets: the two projectors, and Embree on the rays of the same facets.
#pragma once

#include "cli/camera_rays.h"
#include "cli/views.h"

namespace trilens {

/// A viewer that replaces every optic by its N x N grid. `engine`: kExact, kClassic or kFacetsTruth.
/// With kClassic, too, the exact projector finds which facet each sample sees; the classic one draws the
/// objects there, and those that the camera sees itself. Throws InputError where the optics have too many
/// facets to hold.
Viewer make_facet_viewer(const World& world, CameraRays camera, const EngineChoice& engine, const Warn& warn);

}  // namespace trilens
