#include "bench/race/scene_race.h"

#include <algorithm>

#include "base/raymesh/check_data.h"
#include "base/raymesh/rasterize.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "bench/race/times.h"
#include "bench/race/view_collector.h"
#include "render/engines/facet_engine.h"
#include "render/frame/frame.h"
#include "render/picture/sample_colour.h"
#include "render/world/world.h"
#include "scene/data/check_scene.h"

namespace trilens_bench {

using namespace trilens;
namespace {

constexpr std::size_t kBandSamples = 1u << 15;

/// Finds the colours of all samples, for the time that it takes.
void shade(const World& world, const SampleViews& views) {
    std::vector<SampleColour> colours(views.samples.size());
    parallel_for(colours.size(), 1024, [&](std::size_t first, std::size_t last) {
        sample_colours(world, views, first, std::span(colours).subspan(first, last - first));
    });
}

/// What a frame is made of, timed; each time from nothing.
struct Preparation {
    std::unique_ptr<World> world;
    Frame frame;
};

Preparation prepare(const Scene& scene, const BenchRequest& request, const Warn& warn, BenchResult& result) {
    Preparation made;
    std::vector<double> surface, rays;
    const int times = std::max(1, request.race.repeats / 3);
    for (int i = 0; i < times; ++i) {
        const Warn told = i + 1 == times ? warn : Warn([](const std::string&) {});
        made.frame = {};
        Scene copy = scene;
        surface.push_back(milliseconds([&] { made.world = make_world(std::move(copy), told); }));
        check_frame(*made.world, request.frame);
        rays.push_back(milliseconds([&] { made.frame = make_frame(*made.world, request.frame, told); }));
    }
    result.surface_ms = median(surface);
    result.rays_ms = median(rays);
    return made;
}

/// Draws the picture band by band: the rays that leave the optics are collected, the shading is timed.
void draw_bands(const Preparation& made, const SampleGrid& film, ViewCollector* collector,
                const BenchRequest& request, BenchResult& result) {
    const std::size_t row = static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.side) *
                            static_cast<std::size_t>(film.side);
    const int rows = static_cast<int>(std::max<std::size_t>(1, kBandSamples / row));
    std::vector<double> shading(static_cast<std::size_t>(std::max(1, request.race.repeats / 3)), 0);
    SampleGrid band = film;
    const auto keep = [&](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& part) {
        if (collector) collector->add(mesh, owned, part);
    };
    const FacetViews facets = make_facet_views(*made.world, made.frame, Engine::kExact, keep);
    SampleViews views;
    for (int y = film.y0; y < film.y1; y += rows) {
        band.y0 = y, band.y1 = std::min(y + rows, film.y1);
        facets.viewer(band, views);
        for (double& sum : shading) sum += milliseconds([&] { shade(*made.world, views); });
    }
    result.shade_ms = median(shading);
}

}  // namespace

BenchResult run_bench(Scene scene, const BenchRequest& request, const Warn& warn) {
    check_scene(scene);
    if (request.race.repeats < 1) throw UsageError("a benchmark needs at least one repeat");
    BenchResult result;
    const Preparation made = prepare(scene, request, warn, result);
    const Film& film = made.world->scene.film;
    const SampleGrid grid{0, 0, film.width, film.height, film.spp};
    check_sample_grid(grid);

    ViewCollector collector(grid);
    draw_bands(made, grid, made.frame.optics.empty() ? nullptr : &collector, request, result);
    CollectedViews views = collector.take();
    result.direct = views.meshes.empty();
    if (result.direct) views.add(made.frame.camera.mesh, rasterize_facets(made.frame.camera.mesh, grid));
    RaceCourse course{made.world->objects, views.views(), grid};
    result.race = race(course, request.race);
    return result;
}

}  // namespace trilens_bench
