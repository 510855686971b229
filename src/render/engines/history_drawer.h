// One history of the paths over an optic, drawn through its RayMesh.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "paths/facets/optic_paths.h"
#include "render/frame/views.h"

namespace trilens {

/// Of t: an object that lies no farther behind the next optic is seen in it.
inline constexpr double kTouch = 1e-9;
/// The same where it is known that an object lies on the next optic, whose t is interpolated.
inline constexpr double kNearTouch = 0.05;

/// An engine's work on one RayMesh: the nearest triangles along the rays of the owned samples.
using DrawMesh = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&, std::span<Hit>)>;

/// The ends of samples, one history after the other.
struct PathEnds {
    std::vector<PathEnd> ends;
    std::vector<Id> sample;   // of each end
    std::vector<Step> steps;  // PathEnd::first_step counts here
};

/// One history drawn: for each sample of it what it sees, and whether its path goes on.
class HistoryDrawer {
  public:
    /// `leaf`: per sample; kNone: it is not drawn. All must live longer.
    HistoryDrawer(const DrawMesh& draw_mesh, const OpticPaths& paths, const SampleGrid& grid,
                  const std::vector<Id>& leaf)
        : draw_mesh_(draw_mesh), paths_(paths), grid_(grid), leaf_(leaf), goes_on_(paths.nodes.size()) {}

    /// Parents first.
    void draw(Id node, PathEnds& out);

  private:
    bool ends_before_next(Id node, Id facet, const Hit& hit, const Vec3& share) const;
    std::vector<char> find_ends(Id node, const FacetSamples& owned, std::span<const Hit> hits);
    void set_end(Id node, Id facet, const Vec3& share, PathEnd& end) const;

    const DrawMesh& draw_mesh_;
    const OpticPaths& paths_;
    const SampleGrid& grid_;
    const std::vector<Id>& leaf_;
    std::vector<std::vector<char>> goes_on_;  // per node and sample
};

}  // namespace trilens
