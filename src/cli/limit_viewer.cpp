#include "cli/limit_viewer.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "projector/projector.h"
#include "surfaces/surfaces.h"
#include "truth/limit_tracer.h"
#include "truth/optic_ray.h"
#include "truth/tracer.h"

namespace trilens {
namespace {

/// Facets of the fine grid that finds the face under a ray; Newton then finds the exact point, so this only
/// decides how little of a silhouette is missed.
constexpr std::size_t kFineFacets = 400'000;
constexpr int kMinFine = 4, kMaxFine = 256;
/// Cages of so many faces that kMinFine goes beyond this have small faces, which need less: about 1 GB here.
constexpr std::size_t kMostFineFacets = 2'000'000;

int fine_resolution(const Surface& surface) {
    const double per_face = static_cast<double>(kFineFacets) /
                            (2.0 * static_cast<double>(std::max<std::size_t>(1, surface.face_count())));
    const int n = std::clamp(static_cast<int>(std::sqrt(per_face)), kMinFine, kMaxFine);
    return resolution_within(surface, n, kMostFineFacets);
}

struct LimitViewer {
    const World* world = nullptr;
    CameraRays camera;
    std::vector<std::shared_ptr<LimitTracer>> optics;
    std::shared_ptr<Tracer> objects;

    void operator()(const SampleGrid& grid, std::span<SampleView> views) const;

  private:
    void view_sample(SampleView& view) const;
    void follow(const Optic& optic, const SurfaceHit& hit, SampleView& view) const;
    SecondaryView look_along(const std::optional<Ray>& ray) const;
};

SecondaryView LimitViewer::look_along(const std::optional<Ray>& ray) const {
    if (!ray) return {};
    return {true, *ray, objects->first_hit(*ray)};
}

void LimitViewer::follow(const Optic& optic, const SurfaceHit& hit, SampleView& view) const {
    view.hit = {};
    view.depth = hit.t;
    view.facet = hit.face;
    view.uv = hit.uv;
    const double cosine = dot(normalize_or_zero(view.ray.direction), hit.point.normal);
    view.front = cosine <= 0;
    view.cos_incident = std::min(1.0, std::fabs(cosine));

    // The secondary rays carry the eye-to-surface length, as corner rays do.
    const Ray incoming{view.ray.origin, hit.t * view.ray.direction};
    const RenderSettings& settings = world->scene.render;
    if (settings.reflect) view.reflect = look_along(mirrored_ray(incoming, hit));
    if (settings.refract && !optic.mirror)
        view.refract = look_along(refracted_ray(incoming, hit, world->scene.materials[optic.material].ior));
}

void LimitViewer::view_sample(SampleView& view) const {
    view.hit = objects->first_hit(view.ray);
    if (view.hit.seen()) view.depth = view.hit.t;
    std::optional<SurfaceHit> nearest;
    for (std::size_t i = 0; i < optics.size(); ++i) {
        const std::optional<SurfaceHit> hit = optics[i]->first_hit(view.ray);
        if (!hit || hit->t >= view.depth || (nearest && hit->t >= nearest->t)) continue;
        nearest = hit;
        view.optic = static_cast<Id>(i);
    }
    if (nearest) follow(world->optics[view.optic], *nearest, view);
}

void LimitViewer::operator()(const SampleGrid& grid, std::span<SampleView> views) const {
    const FacetSamples owned = rasterize_facets(camera.mesh, grid);
    set_camera_rays(camera.mesh, owned, grid, views);
    parallel_for(owned.sample.size(), 64, [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < to; ++i) view_sample(views[owned.sample[i]]);
    });
}

}  // namespace

Viewer make_limit_viewer(const World& world, CameraRays camera) {
    auto viewer = std::make_shared<LimitViewer>();
    viewer->world = &world;
    viewer->camera = std::move(camera);
    viewer->objects = std::make_shared<Tracer>(world.objects);
    for (const Optic& optic : world.optics) {
        const SurfaceGrid fine = optic.surface->has_closed_form()
                                     ? SurfaceGrid{}
                                     : make_grid(*optic.surface, fine_resolution(*optic.surface));
        viewer->optics.push_back(std::make_shared<LimitTracer>(*optic.surface, fine));
    }
    return [viewer](const SampleGrid& grid, std::span<SampleView> views) { (*viewer)(grid, views); };
}

}  // namespace trilens
