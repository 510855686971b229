// The engines behind one seam: each fills in what every sample shows.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "base/raymesh/sample_grid.h"
#include "render/engines/coverage_bounds.h"
#include "render/frame/frame.h"
#include "render/frame/request.h"
#include "render/frame/views.h"

namespace trilens {

/// Shows a world through one camera by one engine. Facets are worked out when a view first needs them and are
/// kept: what a sample shows does not depend on what was viewed before. One thread at a time.
class Viewer {
  public:
    virtual ~Viewer() = default;

    /// Replaces `views` by what each sample of the grid shows.
    virtual void view(const SampleGrid& grid, SampleViews& views) = 0;

    /// Whether it shows facets; the limit truth has none.
    virtual bool has_facets() const = 0;
    /// The paths over an optic worked out so far: SampleView::leaf and PathEnd::node count in them. Of
    /// viewers with facets.
    virtual const OpticPaths& paths(std::size_t optic) const = 0;
    /// That SampleView::camera_facet counts in; null: the camera has exact rays alone.
    virtual const RayMesh* camera_mesh() const = 0;
    /// The exact rays of a camera that is not linear; null: those of camera_mesh() are.
    virtual const CameraModel* exact_camera() const = 0;

    /// As CoverageBounder::bound(). Where the exact surfaces or the classic engine decide what is seen,
    /// nothing is said.
    virtual void bound_coverage(const SampleGrid& grid, std::span<const Id> shown,
                                std::span<CoverageBounds> bounds) = 0;

    /// Whether it can tell which samples make fragments: engines that project, without outlines.
    virtual bool has_keys() const = 0;
    /// See find_fragment_keys() and find_pixel_keys(). Of viewers with keys.
    virtual void find_keys(const SampleGrid& grid, std::span<FragmentKey> keys) = 0;
    virtual void find_keys_of_pixels(const SampleGrid& grid, std::span<FragmentKey> keys) = 0;
    /// The key of a sample of its own views.
    virtual FragmentKey key_of(const SampleViews& views, const SampleView& view) const = 0;
};

/// Throws UsageError where what is asked of facets is no matter of the engine's: an error (max_error) of
/// engines that show something else, and a proof (certify) of engines whose facets stand for no exact paths.
void check_engine(const FrameParams& frame, Engine engine);

/// What the maker of a viewer hears, and whether it still wants it: once it is cancelled the viewer, too,
/// throws Interrupted.
struct ViewerCallbacks {
    Warn warn = {};
    const std::atomic<bool>* cancel = nullptr;
};

/// A viewer of `world`, which must outlive it. Throws as check_engine, and InputError where the camera cannot
/// show what the scene has, or the optics have too many facets to hold.
std::unique_ptr<Viewer> make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                                    const ViewerCallbacks& callbacks);
inline std::unique_ptr<Viewer> make_viewer(const World& world, const FrameParams& frame,
                                           const EngineChoice& engine, const Warn& warn) {
    return make_viewer(world, frame, engine, ViewerCallbacks{warn});
}

// Views through facets: the two projectors, and Embree on the rays of the same facets.

/// A viewer in which every optic is its N x N grid. `engine`: any but kLimitTruth. With
/// kClassic, too, the exact projector finds which facet each sample sees; the classic one draws the objects
/// there, and those that the camera sees itself. `watch`: told every RayMesh that leaves an optic and is
/// drawn through, with the samples that it is drawn at and the grid that they count in; all only live for the
/// call.
using WatchMesh = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&)>;
std::unique_ptr<Viewer> make_facet_viewer(const World& world, Frame frame, const EngineChoice& engine,
                                          const WatchMesh& watch = {});

// Viewer of the exact surfaces: the limit truth.

/// A viewer that follows every sample's camera ray to the exact surface and on into the scene.
std::unique_ptr<Viewer> make_limit_viewer(const World& world, CameraRays camera);

}  // namespace trilens
