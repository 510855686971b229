#include "bench/race/scene_race.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/raymesh/rasterize.h"
#include "base/raymesh/sample_grid.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/parallel.h"
#include "bench/race/race.h"
#include "intersect/tracer.h"
#include "render/engines/engine.h"
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
    const std::unique_ptr<Viewer> viewer = make_facet_viewer(*made.world, made.frame, Engine::kExact, keep);
    SampleViews views;
    for (int y = film.y0; y < film.y1; y += rows) {
        band.y0 = y, band.y1 = std::min(y + rows, film.y1);
        viewer->view(band, views);
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

// From hit to hit along a share of the rays.

using namespace trilens;
namespace {

constexpr std::size_t kEvery = 64;

std::size_t depths_along(const Tracer& tracer, const Ray& ray) {
    std::size_t depths = 0;
    double from = 0;
    for (Hit hit = tracer.first_hit(ray, from); hit.seen(); hit = tracer.first_hit(ray, from)) {
        ++depths;
        from = std::nextafter(hit.t * (1 + 2 * kDepthTie), INFINITY);
    }
    return depths;
}

}  // namespace

double depth_complexity(const RaceCourse& course) {
    const Tracer tracer(course.scene);
    std::atomic<std::size_t> depths = 0, rays = 0;
    for (const RaceView& view : course.views) {
        parallel_for(view.mesh->facets.size(), 64, [&](std::size_t first, std::size_t last) {
            for (std::size_t f = first; f < last; ++f) {
                const std::span<const Id> own = view.owned->of(f);
                if (own.empty() || !view.mesh->has_rays(f)) continue;
                const FacetWeights weights = facet_weights(*view.mesh, f);
                for (std::size_t i = 0; i < own.size(); i += kEvery) {
                    const Vec2 position = course.grid.position(own[i]);
                    depths += depths_along(tracer, sample_ray(*view.mesh, f, weights, position));
                    ++rays;
                }
            }
        });
    }
    return rays == 0 ? 0 : static_cast<double>(depths) / static_cast<double>(rays);
}

using namespace trilens;
namespace {

bool same(const Ray& a, const Ray& b) {
    return a.origin == b.origin && a.direction == b.direction;
}

bool same(const RayMesh& a, const RayMesh& b) {
    return a.rays.size() == b.rays.size() && a.facets == b.facets && a.screen == b.screen &&
           std::equal(a.rays.begin(), a.rays.end(), b.rays.begin(),
                      [](const Ray& p, const Ray& q) { return same(p, q); });
}

FacetSamples grouped(const std::vector<std::pair<Id, Id>>& owned, std::size_t facets) {
    FacetSamples samples;
    samples.first.assign(facets + 1, 0);
    for (const auto& [facet, sample] : owned) ++samples.first[facet + 1];
    for (std::size_t f = 0; f < facets; ++f) samples.first[f + 1] += samples.first[f];
    samples.sample.resize(owned.size());
    std::vector<std::size_t> next(samples.first.begin(), samples.first.end() - 1);
    for (const auto& [facet, sample] : owned) samples.sample[next[facet]++] = sample;
    return samples;
}

}  // namespace

void ViewCollector::add(const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& part) {
    if (owned.sample.empty()) return;
    auto own = std::find_if(parts_.begin(), parts_.end(), [&](const Part& p) { return same(p.mesh, mesh); });
    if (own == parts_.end()) own = parts_.insert(own, Part{mesh, {}});
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
        for (const Id sample : owned.of(f))
            own->owned.emplace_back(static_cast<Id>(f), static_cast<Id>(part.sample_in(film_, sample)));
}

CollectedViews ViewCollector::take() {
    CollectedViews views;
    for (; !parts_.empty(); parts_.pop_front()) {
        Part& part = parts_.front();
        FacetSamples owned = grouped(part.owned, part.mesh.facets.size());
        views.add(std::move(part.mesh), std::move(owned));
    }
    return views;
}

using namespace trilens;
namespace {

nlohmann::ordered_json fields(const BenchResult& bench) {
    const RaceResult& r = bench.race;
    return {{"pixels", r.pixels},
            {"facets", r.facets},
            {"triangles", r.triangles},
            {"depth_complexity", r.depth_complexity},
            {"rays", bench.direct ? "direct" : "optics"},
            {"threads", r.threads},
            {"isa", r.projector_isa},
            {"surface_ms", bench.surface_ms},
            {"rays_ms", bench.rays_ms},
            {"shade_ms", bench.shade_ms},
            {"projector",
             {{"prepare_ms", r.prepare_ms},
              {"samples_ms", r.samples_ms},
              {"visible_ms", r.visible_ms},
              {"written_ms", r.written_ms},
              {"whole_ms", r.whole_ms},
              {"shared", r.shared},
              {"ambiguous", r.ambiguous},
              {"unbounded", r.unbounded}}},
            {"embree",
             {{"build_ms", r.build_ms},
              {"rays_ms", r.rays_ms},
              {"trace_ms", r.trace_ms},
              {"written_ms", r.trace_written_ms},
              {"configuration", r.embree_configuration},
              {"rays_at_once", r.rays_at_once}}},
            {"ratio",
             {{"visible", r.ratio.visible},
              {"written", r.ratio.written},
              {"written_low", r.slowest_ratio},
              {"written_high", r.fastest_ratio},
              {"with_build", r.ratio.with_build},
              {"whole", r.ratio.whole}}},
            {"mismatch_pixels", r.mismatches.pixels},
            {"mismatch",
             {{"edge", r.mismatches.edge},
              {"depth", r.mismatches.depth},
              {"unexplained", r.mismatches.unexplained}}}};
}

std::string line(const std::string& phase, double projector, double embree) {
    return fmt::format("{:<34} {:>10.3f} {:>10.3f} {:>7.2f}\n", phase, projector, embree, embree / projector);
}

std::string text(const BenchResult& bench) {
    const RaceResult& r = bench.race;
    std::string text = fmt::format(
        "{} pixels through {} facets, {} rays; {} triangles in {:.1f} layers; {} thread{}, {}\n"
        "Embree: {}, packets of {}, coherent, triangles and rays in float\n"
        "medians: surfaces {:.1f} ms, corner rays {:.1f} ms, shading of all samples {:.1f} ms\n\n",
        r.pixels, r.facets, bench.direct ? "the camera's own" : "the optics'", r.triangles,
        r.depth_complexity, r.threads, r.threads == 1 ? "" : "s", r.projector_isa, r.embree_configuration,
        r.rays_at_once, bench.surface_ms, bench.rays_ms, bench.shade_ms);
    text += fmt::format("{:<34} {:>10} {:>10} {:>7}\n", "medians, ms", "projector", "Embree", "ratio");
    text += line("tree", r.prepare_ms, r.build_ms);
    text += line("samples in vectors, rays in packets", r.samples_ms, r.rays_ms);
    text += line("triangles seen, t within bounds", r.visible_ms, r.trace_ms);
    text +=
        fmt::format("{:<34} {:>10.3f} {:>10.3f} {:>7.2f}  ({:.2f} to {:.2f})\n", "hits written per sample",
                    r.written_ms, r.trace_written_ms, r.ratio.written, r.slowest_ratio, r.fastest_ratio);
    text += line("samples, rays and hits per sample", r.whole_ms, r.rays_ms + r.trace_written_ms);
    text += fmt::format("with both trees {:.2f}, with samples, rays and trees {:.2f} times Embree's speed\n",
                        r.ratio.with_build, r.ratio.whole);
    text += fmt::format(
        "of the pixels {:.1f} % lie in vectors that facets share, {:.2f} % were decided exactly, {:.2f} % "
        "one by one\n",
        100 * r.shared, 100 * r.ambiguous, 100 * r.unbounded);
    text += fmt::format(
        "{} pixels differ: {} within a thousandth of an edge, {} at one depth to a thousandth, {} otherwise",
        r.mismatches.pixels, r.mismatches.edge, r.mismatches.depth, r.mismatches.unexplained);
    return text;
}

}  // namespace

std::string race_json(const BenchResult& bench) {
    nlohmann::ordered_json json = fields(bench);
    json["schema"] = "trilens.bench/1";
    return json.dump(2) + "\n";
}

std::string race_text(const BenchResult& bench) {
    return text(bench) + "\n";
}

}  // namespace trilens_bench
