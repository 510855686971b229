// What colour a sample has: the light of its direct view, or of its paths over an optic, weighted.
#pragma once

#include <optional>

#include "base/raymesh/sample_grid.h"
#include "render/engines/engine.h"
#include "render/frame/camera_rays.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

class RayDifferentials;

/// Shades what samples show: colours[i] is that of views.samples[first + i]. Samples do not see each other:
/// a colour has the same bits whatever it is asked with. `differentials`: of the views' samples, over which
/// textures are averaged; null: each sample is a point.
void sample_colours(const World& world, const SampleViews& views, std::size_t first,
                    std::span<SampleColour> colours, const RayDifferentials* differentials = nullptr);

/// Shades what one sample, an element of views.samples, shows.
SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view,
                           const RayDifferentials* differentials = nullptr);

/// What one ray of a sample adds to it.
struct Contribution {
    SeenAlong seen;
    Vec3 weight{0};                // of its light
    const PathEnd* end = nullptr;  // null: what the camera sees itself
    // From the last optic to what is seen, in scene units, where it stands for more than its own sample.
    std::optional<double> mean_length = std::nullopt;
};

/// What volumes let through between the camera and what the sample shows first.
inline double through_volumes(const SampleViews& views, const SampleView& view) {
    const SampleVolumes* volumes = views.volumes_of(view);
    return volumes ? volumes->first.transmittance : 1;
}

/// Calls body(contribution) for all that a sample shows.
template <typename Body>
void for_each_contribution(const World& world, const SampleViews& views, const SampleView& view,
                           const Body& body) {
    if (view.ray.direction == Vec3(0)) return;  // the camera has no ray there
    if (view.optic == kNone) {
        if (world.scene.render.direct)
            body(Contribution{{&view.hit, &view.ray},
                              through_volumes(views, view) * light_of_view(world, views, view)});
        return;
    }
    OpticWeights weights = first_weights(world, views, view);
    weights.reflect *= through_volumes(views, view);
    weights.refract *= through_volumes(views, view);
    for (const PathEnd& end : views.ends_of(view)) {
        const Vec3 weight = (end.path == Path::kReflect ? weights.reflect : weights.refract) * end.weight;
        if (weight != Vec3(0)) body(Contribution{{&end.hit, &end.ray}, weight, &end});
    }
}

/// A sample's colour before light is added: where it shows a mesh, and what volumes emit on the way to all
/// that it shows.
SampleColour unlit_colour(const World& world, const SampleViews& views, const SampleView& view);

/// Adds the light that is seen along a contribution's ray.
void add_light(const World& world, const Contribution& from, Vec3 light, SampleColour& colour);

/// Adds a colour to a weighted sum of them.
inline void add(SampleColour& sum, double weight, const SampleColour& one) {
    sum.direct += weight * one.direct;
    sum.reflect += weight * one.reflect;
    sum.refract += weight * one.refract;
    sum.coverage += weight * one.coverage;
}

/// Distance from the last optic to what is seen, in scene units; the end sees something.
double path_length(const PathEnd& end);

// Ray differentials: how what samples see moves with their place on the film, of facets in closed form, of
// paths that were traced by differences of exact rays.
// Source: Igehy, Tracing Ray Differentials, SIGGRAPH 1999.

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

/// The differentials of the samples of one grid of views.
class RayDifferentials {
  public:
    /// `cancel`: set once nobody wants the colours any more; see Receiver.
    RayDifferentials(const World& world, const Viewer& viewer, const SampleGrid& grid,
                     const std::atomic<bool>* cancel = nullptr)
        : world_(world), viewer_(viewer), grid_(grid), cancel_(cancel) {}

    /// Of a contribution's ray, per pixel; none where rays beside it have another history or none.
    std::optional<RayDifferential> of(const SampleViews& views, std::size_t sample,
                                      const Contribution& contribution) const;

    /// Samples along each side of a pixel: a sample stands for that part of it.
    int side() const { return grid_.side; }
    /// Whether every ray is exact: light is then to be, too.
    bool are_traced() const;
    /// Where a sample stands on the film.
    Vec2 place(std::size_t sample) const { return grid_.position(sample); }
    const std::atomic<bool>* cancel() const { return cancel_; }

  private:
    std::optional<Ray> camera_ray(const SampleView& view, const Vec2& place) const;
    std::optional<Ray> ray_beside(const SampleViews& views, const SampleView& view, const PathEnd* end,
                                  const Vec2& place) const;

    const World& world_;
    const Viewer& viewer_;
    SampleGrid grid_;
    const std::atomic<bool>* cancel_;
};

}  // namespace trilens
