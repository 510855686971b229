// The engines behind one seam: each fills in what every sample shows.
#pragma once

#include <functional>

#include "base/raymesh/sample_grid.h"
#include "render/frame/fragment_key.h"
#include "render/frame/frame.h"
#include "render/frame/request.h"
#include "render/frame/views.h"

namespace trilens {

/// Replaces `views` by what each sample of the grid shows.
using Viewer = std::function<void(const SampleGrid& grid, SampleViews& views)>;

/// A viewer, and what it has of facets. The limit truth has none: no `paths` and no `keys`.
struct FacetViews {
    Viewer viewer;
    /// The paths over each optic worked out so far: SampleView::leaf and PathEnd::node count in them.
    std::function<const OpticPaths&(std::size_t optic)> paths;
    const RayMesh* camera = nullptr;  // that SampleView::camera_facet counts in
    // The exact rays of a camera that is not linear; null: those of `camera` are.
    const CameraModel* exact_camera = nullptr;

    /// Which samples make fragments: set for engines that project without outlines. `find`: see
    /// find_fragment_keys(); `of`: the key of a sample of the viewer's.
    struct Keys {
        std::function<void(const SampleGrid& grid, std::span<FragmentKey> keys)> find;
        std::function<FragmentKey(const SampleViews& views, const SampleView& view)> of;
    };
    Keys keys;
};

/// Views of `world`, which must outlive them. Throws InputError where the camera cannot show what the scene
/// has, or the optics have too many facets to hold.
FacetViews make_views(const World& world, const FrameParams& frame, const EngineChoice& engine,
                      const Warn& warn);

/// Its viewer alone.
Viewer make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                   const Warn& warn);

}  // namespace trilens
