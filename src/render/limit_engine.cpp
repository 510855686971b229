#include "render/limit_engine.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/rasterize.h"
#include "paths/optic_ray.h"
#include "render/geometry.h"

namespace trilens {
namespace {

constexpr std::size_t kSamplesPerTask = 256;

struct LimitViewer {
    const World* world = nullptr;
    CameraRays camera;
    std::vector<const LimitTracer*> optics;
    const Tracer* objects = nullptr;

    void operator()(const SampleGrid& grid, SampleViews& views) const;

  private:
    void view_sample(SampleView& view, std::vector<PathEnd>& ends) const;
    void follow(const Optic& optic, const SurfaceHit& hit, SampleView& view,
                std::vector<PathEnd>& ends) const;
};

void LimitViewer::follow(const Optic& optic, const SurfaceHit& hit, SampleView& view,
                         std::vector<PathEnd>& ends) const {
    view.hit = {};
    view.depth = hit.t;
    view.facet = hit.face;
    view.uv = hit.uv;
    const double cosine = dot(normalize_or_zero(view.ray.direction), hit.point.normal);
    view.incidence = {std::min(1.0, std::fabs(cosine)), cosine <= 0};

    // The rays that leave carry the eye-to-surface length, as corner rays do.
    const Ray incoming{view.ray.origin, hit.t * view.ray.direction};
    const auto add = [&](Path path, const std::optional<Ray>& ray) {
        if (ray) ends.push_back({path, kNone, *ray, objects->first_hit(*ray)});
    };
    const RenderSettings& settings = world->scene.render;
    if (settings.reflect) add(Path::kReflect, mirrored_ray(incoming, hit));
    if (settings.refract && !optic.mirror)
        add(Path::kRefract, refracted_ray(incoming, hit, world->scene.materials[optic.material].ior));
}

void LimitViewer::view_sample(SampleView& view, std::vector<PathEnd>& ends) const {
    const double reach = camera.far_depth - camera.near_depth;
    view.hit = objects->first_hit(view.ray);
    if (view.hit.seen() && view.hit.t > reach) view.hit = {};
    if (view.hit.seen()) view.depth = view.hit.t;
    std::optional<SurfaceHit> nearest;
    for (std::size_t i = 0; i < optics.size(); ++i) {
        const std::optional<SurfaceHit> hit = optics[i]->first_hit(view.ray);
        if (!hit || hit->t > reach || hit->t >= view.depth || (nearest && hit->t >= nearest->t)) continue;
        nearest = hit;
        view.optic = static_cast<Id>(i);
    }
    view.first_end = ends.size();
    if (nearest) follow(world->optics[view.optic], *nearest, view, ends);
    view.end_count = ends.size() - view.first_end;
}

void LimitViewer::operator()(const SampleGrid& grid, SampleViews& views) const {
    views.reset(grid.size());
    FacetSamples owned;
    if (camera.model) {
        owned = set_exact_rays(*camera.model, grid, views.samples);
    } else {
        owned = rasterize_facets(camera.mesh, grid);
        set_camera_rays(camera.mesh, owned, grid, views.samples);
    }

    // Each task keeps its own ends; put one after the other they do not depend on who did which.
    const std::size_t count = owned.sample.size();
    std::vector<std::vector<PathEnd>> ends((count + kSamplesPerTask - 1) / kSamplesPerTask);
    const auto samples_of = [&](std::size_t task) {
        const std::size_t first = task * kSamplesPerTask;
        return std::span(owned.sample).subspan(first, std::min(kSamplesPerTask, count - first));
    };
    parallel_for(ends.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t task = from; task < to; ++task)
            for (const Id s : samples_of(task)) view_sample(views.samples[s], ends[task]);
    });
    for (std::size_t task = 0; task < ends.size(); ++task) {
        for (const Id s : samples_of(task)) views.samples[s].first_end += views.ends.size();
        views.ends.insert(views.ends.end(), ends[task].begin(), ends[task].end());
    }
    count_from_eye(camera, views.samples);
}

}  // namespace

Viewer make_limit_viewer(const World& world, CameraRays camera) {
    auto viewer = std::make_shared<LimitViewer>();
    viewer->world = &world;
    viewer->camera = std::move(camera);
    viewer->objects = &object_tracer(world);
    for (std::size_t i = 0; i < world.optics.size(); ++i) viewer->optics.push_back(&limit_tracer(world, i));
    return [viewer](const SampleGrid& grid, SampleViews& views) { (*viewer)(grid, views); };
}

}  // namespace trilens
