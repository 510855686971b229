#include "render/engines/limit_engine.h"

#include <algorithm>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "render/engines/first_surface.h"
#include "render/engines/trace_samples.h"
#include "render/frame/camera_media.h"
#include "render/world/geometry.h"

namespace trilens {
namespace {

constexpr std::size_t kSamplesPerTask = 256;

/// What one task finds; put one after the other they do not depend on who did which.
struct Found {
    std::vector<PathEnd> ends;
    std::vector<Step> steps;
};

struct LimitViewer {
    const World* world = nullptr;
    CameraRays camera;
    const PathWorld* paths = nullptr;
    const Tracer* objects = nullptr;
    CameraMedia camera_media;

    void operator()(const SampleGrid& grid, SampleViews& views) const;

  private:
    void view_sample(SampleView& view, OpticView& on_optic, const Media& around, Found& found) const;
};

void LimitViewer::view_sample(SampleView& view, OpticView& on_optic, const Media& around,
                              Found& found) const {
    const double reach = camera.far_depth - camera.near_depth;
    const FirstSurface first = first_surface(*paths, *objects, view.ray, reach);
    view.hit = first.object;
    if (view.hit.seen()) view.depth = view.hit.t;
    if (first.optic == kNone) return;
    view.optic = first.optic;
    view.depth = first.at.t;
    view.facet = first.at.face;
    on_optic = {};
    on_optic.uv = first.at.uv;
    on_optic.first_end = found.ends.size();
    follow_sample(*world, {first.at, around}, view, {on_optic, found.ends, found.steps});
    on_optic.end_count = found.ends.size() - on_optic.first_end;
}

void LimitViewer::operator()(const SampleGrid& grid, SampleViews& views) const {
    views.reset(grid.size());
    FacetSamples owned;
    if (camera.model) {
        owned = set_exact_rays(*camera.model, grid, views.samples);
    } else {
        owned = rasterize_facets(camera.mesh, grid);
        for_each_camera_ray(camera.mesh, owned, grid, [&](Id s, Id facet, const Ray& ray) {
            views.samples[s].ray = ray;
            views.samples[s].camera_facet = facet;
        });
    }

    set_initial_media(camera_media, views);
    const std::size_t count = owned.sample.size();
    std::vector<Found> found((count + kSamplesPerTask - 1) / kSamplesPerTask);
    const auto samples_of = [&](std::size_t task) {
        const std::size_t first = task * kSamplesPerTask;
        return std::span(owned.sample).subspan(first, std::min(kSamplesPerTask, count - first));
    };
    parallel_for(found.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t task = from; task < to; ++task)
            for (const Id s : samples_of(task)) {
                SampleView& view = views.samples[s];
                view_sample(view, views.of_optics[s], views.around_of(view), found[task]);
            }
    });
    for (std::size_t task = 0; task < found.size(); ++task) {
        for (const Id s : samples_of(task))
            if (views.samples[s].optic != kNone) views.of_optics[s].first_end += views.ends.size();
        for (PathEnd& end : found[task].ends) end.first_step += views.steps.size();
        views.ends.insert(views.ends.end(), found[task].ends.begin(), found[task].ends.end());
        views.steps.insert(views.steps.end(), found[task].steps.begin(), found[task].steps.end());
    }
    count_from_eye(camera, views.samples);
}

}  // namespace

FacetViews make_limit_views(const World& world, CameraRays camera) {
    auto viewer = std::make_shared<LimitViewer>();
    viewer->world = &world;
    viewer->camera_media = camera_media_of(world, camera);
    viewer->camera = std::move(camera);
    viewer->objects = &object_tracer(world);
    viewer->paths = &path_world(world);
    FacetViews views;
    views.viewer = [viewer](const SampleGrid& grid, SampleViews& seen) { (*viewer)(grid, seen); };
    views.camera = viewer->camera.model ? nullptr : &viewer->camera.mesh;
    views.exact_camera = viewer->camera.model.get();
    return views;
}

}  // namespace trilens
