// Views through facets: the two projectors, and Embree on the rays of the same facets.
#pragma once

#include <functional>

#include "render/engines/engine.h"

namespace trilens {

/// A viewer in which every optic is its N x N grid. `engine`: any but kLimitTruth. With
/// kClassic, too, the exact projector finds which facet each sample sees; the classic one draws the objects
/// there, and those that the camera sees itself. `watch`: told every RayMesh that leaves an optic and is
/// drawn through, with the samples that it is drawn at and the grid that they count in; all only live for the
/// call.
using WatchMesh = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&)>;
std::unique_ptr<Viewer> make_facet_viewer(const World& world, Frame frame, const EngineChoice& engine,
                                          const WatchMesh& watch = {});

}  // namespace trilens
