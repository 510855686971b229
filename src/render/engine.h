// The engines behind one seam: each fills in what every sample shows.
#pragma once

#include <functional>

#include "base/sample_grid.h"
#include "render/frame.h"
#include "render/request.h"
#include "render/views.h"

namespace trilens {

/// Replaces `views` by what each sample of the grid shows.
using Viewer = std::function<void(const SampleGrid& grid, SampleViews& views)>;

/// A viewer of `world`, which must outlive it. Throws InputError where the camera cannot show what the scene
/// has, or the optics have too many facets to hold.
Viewer make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                   const Warn& warn);

}  // namespace trilens
