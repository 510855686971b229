// Ray differentials: how what samples see moves with their place on the film, of facets in closed form, of
// paths that were traced by differences of exact rays.
// Source: Igehy, Tracing Ray Differentials, SIGGRAPH 1999.
#pragma once

#include <optional>

#include "base/raymesh/sample_grid.h"
#include "render/engines/engine.h"
#include "render/picture/sample_colour.h"

namespace trilens {

/// The rays of a facet as a function of the film: quotients of polynomials in the place.
struct FacetMap {
    const RayMesh* mesh = nullptr;  // null: there is none
    Id facet = kNone;
    FacetWeights weights;

    Ray at(const Vec2& place) const { return sample_ray(*mesh, facet, weights, place); }
    /// The derivatives of at() by x and by y, per pixel.
    RayDifferential differential(const Vec2& place) const;
};

/// The map of the facet that a sample's path leads over (`end`; null: of the camera's own ray); none where it
/// was traced, or the facet is seen edge on.
FacetMap facet_map(const Viewer& viewer, const SampleView& view, const PathEnd* end);

/// The differentials of the samples of one grid of views, whose pixels have one sample.
class RayDifferentials {
  public:
    RayDifferentials(const World& world, const Viewer& viewer, const SampleGrid& grid)
        : world_(world), viewer_(viewer), grid_(grid) {}

    /// Of a contribution's ray, per pixel; none where rays beside it have another history or none.
    std::optional<RayDifferential> of(const SampleViews& views, std::size_t sample,
                                      const Contribution& contribution) const;

  private:
    std::optional<Ray> camera_ray(const SampleView& view, const Vec2& place) const;
    std::optional<Ray> ray_beside(const SampleViews& views, const SampleView& view, const PathEnd* end,
                                  const Vec2& place) const;

    const World& world_;
    const Viewer& viewer_;
    SampleGrid grid_;
};

}  // namespace trilens
