#include "trilens/bench.h"

#include <utility>

#include "base/error.h"
#include "base/rasterize.h"
#include "base/stopwatch.h"
#include "render/engine.h"
#include "render/frame.h"
#include "render/world.h"
#include "scene/check_scene.h"

namespace trilens {
namespace {

/// Who owns the film's samples, for each path of each optic that is seen.
struct OpticRays {
    std::vector<FacetSamples> owned;
    std::vector<const RayMesh*> mesh;
};

OpticRays optic_rays(const Frame& frame, const SampleViews& views) {
    OpticRays rays;
    std::vector<Id> owner(views.samples.size());
    for (std::size_t i = 0; i < frame.optics.size(); ++i) {
        bool any = false;
        for (std::size_t s = 0; s < owner.size(); ++s) {
            const SampleView& view = views.samples[s];
            owner[s] = view.optic == i ? view.facet : kNone;
            any = any || view.optic == i;
        }
        for (const PathMesh& path : frame.optics[i].paths) {
            if (!any || path.mesh.facets.empty()) continue;
            rays.mesh.push_back(&path.mesh);
            rays.owned.push_back(group_by_facet(owner, path.mesh.facets.size()));
        }
    }
    return rays;
}

}  // namespace

BenchResult run_bench(Scene scene, const BenchRequest& request, const Warn& warn) {
    check_scene(scene);
    if (request.race.repeats < 1) throw UsageError("a benchmark needs at least one repeat");
    BenchResult result;
    const Stopwatch surface_watch;
    const std::unique_ptr<World> world = make_world(std::move(scene), warn);
    result.surface_ms = 1000 * surface_watch.seconds();

    const Stopwatch rays_watch;
    const Frame frame = make_frame(*world, request.frame, warn);
    const Film& film = world->scene.film;
    const SampleGrid grid{0, 0, film.width, film.height, film.spp};
    OpticRays rays;
    if (!frame.optics.empty()) {
        SampleViews views;
        make_viewer(*world, request.frame, Engine::kExact, {})(grid, views);
        rays = optic_rays(frame, views);
    }
    if (rays.mesh.empty()) {
        result.direct = true;
        rays.mesh.push_back(&frame.camera.mesh);
        rays.owned.push_back(rasterize_facets(frame.camera.mesh, grid));
    }
    result.rays_ms = 1000 * rays_watch.seconds();
    RaceCourse course{world->objects, {}, grid};
    for (std::size_t i = 0; i < rays.mesh.size(); ++i) course.views.push_back({rays.mesh[i], &rays.owned[i]});
    result.race = race(course, request.race);
    return result;
}

}  // namespace trilens
