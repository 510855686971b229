// The engines behind one seam: each fills in what every sample shows.
#pragma once

#include <functional>

#include "base/raymesh/sample_grid.h"
#include "render/frame/frame.h"
#include "render/frame/request.h"
#include "render/frame/views.h"

namespace trilens {

/// Replaces `views` by what each sample of the grid shows.
using Viewer = std::function<void(const SampleGrid& grid, SampleViews& views)>;

/// A viewer, and the paths over each optic that it has worked out so far: SampleView::leaf and PathEnd::node
/// count in them. The limit truth has no facets, and no `paths`.
struct FacetViews {
    Viewer viewer;
    std::function<const OpticPaths&(std::size_t optic)> paths;
};

/// Views of `world`, which must outlive them. Throws InputError where the camera cannot show what the scene
/// has, or the optics have too many facets to hold.
FacetViews make_views(const World& world, const FrameParams& frame, const EngineChoice& engine,
                      const Warn& warn);

/// Its viewer alone.
Viewer make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                   const Warn& warn);

}  // namespace trilens
