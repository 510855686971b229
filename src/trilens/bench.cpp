#include "trilens/bench.h"

#include <deque>
#include <utility>

#include "base/error.h"
#include "base/rasterize.h"
#include "base/stopwatch.h"
#include "render/facet_engine.h"
#include "render/frame.h"
#include "render/world.h"
#include "scene/check_scene.h"

namespace trilens {
namespace {

/// Rays that look at the scene, kept.
struct BenchRays {
    std::deque<RayMesh> mesh;
    std::deque<FacetSamples> owned;
    std::vector<RaceView> views;

    void add(const RayMesh& rays, const FacetSamples& samples) {
        if (samples.sample.empty()) return;
        views.push_back({&mesh.emplace_back(rays), &owned.emplace_back(samples)});
    }
};

/// All that leave the optics, found by drawing the picture once.
BenchRays optic_rays(const World& world, const Frame& frame, const SampleGrid& grid) {
    BenchRays rays;
    const auto keep = [&](const RayMesh& mesh, const FacetSamples& owned) { rays.add(mesh, owned); };
    SampleViews views;
    make_facet_views(world, frame, Engine::kExact, keep).viewer(grid, views);
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
    BenchRays rays;
    if (!frame.optics.empty()) rays = optic_rays(*world, frame, grid);
    result.direct = rays.views.empty();
    if (result.direct) rays.add(frame.camera.mesh, rasterize_facets(frame.camera.mesh, grid));
    result.rays_ms = 1000 * rays_watch.seconds();
    RaceCourse course{world->objects, rays.views, grid};
    result.race = race(course, request.race);
    return result;
}

}  // namespace trilens
