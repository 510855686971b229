// Times both sides by turns, so that what else the machine does meets both alike.
#include "bench/race/race.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/raymesh/sample_grid.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "bench/race/packet_tracer.h"
#include "bench/race/scene_race.h"
#include "projector/projector.h"
#include "projector/scene/bvh.h"
#include "projector/tiles/sample_tiles.h"

namespace trilens_bench {

using namespace trilens;
namespace {

/// Holds the projector to an instruction set while it lives.
struct HeldSet {
    explicit HeldSet(const std::string& isa) {
        if (!use_instruction_set(isa))
            throw UsageError("the projector has no instruction set '" + isa + "' on this machine");
    }
    ~HeldSet() { use_instruction_set(""); }
    HeldSet(const HeldSet&) = delete;
    HeldSet& operator=(const HeldSet&) = delete;
};

/// How near to a triangle's edge (as a share of its height) and at which t a ray passes its plane.
struct PlaneMeeting {
    double t = 0, edge = -INFINITY;
};

PlaneMeeting meet_plane(const TriangleScene& scene, Id triangle, const Ray& ray) {
    if (triangle == kNone) return {};
    const IdTriple& c = scene.triangles[triangle];
    const Vec3 a = scene.points[c[0]], e1 = scene.points[c[1]] - a, e2 = scene.points[c[2]] - a;
    const Vec3 p = ray.origin - a, q = cross(ray.direction, e2), r = cross(p, e1);
    const double determinant = dot(e1, q);
    if (determinant == 0) return {};
    const double b1 = dot(p, q) / determinant, b2 = dot(ray.direction, r) / determinant;
    return {dot(e2, r) / determinant, std::min({b1, b2, 1 - b1 - b2})};
}

/// Both sides trust what they draw.
void check_course(const RaceCourse& course, const RaceParams& params) {
    if (params.repeats < 1) throw UsageError("a race needs at least one repeat");
    check_triangle_scene(course.scene);
    check_sample_grid(course.grid);
    for (const RaceView& view : course.views) {
        if (!view.mesh || !view.owned) throw InputError("", "views", "a view has a mesh and samples");
        check_facet_corners(*view.mesh);
        const std::vector<std::size_t>& first = view.owned->first;
        if (first.size() != view.mesh->facets.size() + 1 || first.front() != 0 ||
            first.back() != view.owned->sample.size() || !std::is_sorted(first.begin(), first.end()))
            throw InputError("", "views", "samples are grouped by the facets of their mesh");
        for (const Id sample : view.owned->sample)
            if (sample >= course.grid.size()) throw InputError("", "views", "a sample is none of the grid");
    }
}

/// Both sides' inputs that are made beforehand, and their outputs, for one view.
struct View {
    const RayMesh& mesh;
    const FacetSamples& owned;
    SampleTiles tiles;
    std::vector<RayPacket> packets;
    std::vector<VectorVisible> vector_visible;
    std::vector<PacketHits> packet_hits;
};

/// Hits by sample, of one view after the other.
struct SampleHits {
    std::vector<Hit> ours;
    std::vector<FloatHit> theirs;
};

void explain(const RaceCourse& course, const View& view, const SampleHits& hits, Mismatches& found) {
    constexpr double kHair = 1e-3;
    for (std::size_t f = 0; f + 1 < view.owned.first.size(); ++f) {
        if (!view.mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(view.mesh, f);
        for (const Id s : view.owned.of(f)) {
            const Hit& ours = hits.ours[s];
            const Id theirs = hits.theirs[s].triangle;
            if (ours.triangle == theirs) continue;
            ++found.pixels;
            const Ray ray = sample_ray(view.mesh, f, weights, course.grid.position(s));
            const PlaneMeeting a = meet_plane(course.scene, ours.triangle, ray),
                               b = meet_plane(course.scene, theirs, ray);
            const bool at_edge = std::fabs(a.edge) < kHair || std::fabs(b.edge) < kHair;
            const bool at_depth =
                ours.seen() && theirs != kNone && std::fabs(a.t - b.t) <= kHair * std::fabs(a.t);
            ++(at_edge ? found.edge : at_depth ? found.depth : found.unexplained);
        }
    }
}

/// What is visible must be what was drawn.
void check_visible(const View& view, const std::vector<Hit>& hits) {
    for (std::size_t v = 0; v < view.vector_visible.size(); ++v) {
        const VectorVisible& visible = view.vector_visible[v];
        for (std::size_t k = 0; k < kLanes; ++k) {
            if (!(view.tiles.valid[v] >> k & 1)) continue;
            const Hit& hit = hits[view.tiles.samples[v].sample[k]];
            TRILENS_CHECK(visible.triangle[k] == hit.triangle, "visible is what is hit");
            TRILENS_CHECK(!hit.seen() || (static_cast<double>(visible.t_low[k]) <= hit.t &&
                                          hit.t <= static_cast<double>(visible.t_high[k])),
                          "a hit lies within its bounds");
        }
    }
}

View make_view(const RaceView& view, const SampleGrid& grid, std::size_t triangles) {
    View made{*view.mesh,
              *view.owned,
              make_sample_tiles(*view.mesh, *view.owned, grid, tile_params(triangles)),
              make_ray_packets(*view.mesh, *view.owned, grid),
              {},
              {}};
    made.vector_visible.resize(made.tiles.vectors.size());
    made.packet_hits.resize(made.packets.size());
    return made;
}

/// Both sides, ready to run.
struct Sides {
    PreparedScene prepared;
    PacketTracer tracer;
    std::vector<View> views;
    SampleHits hits;
};

struct Times {
    std::vector<double> visible, written, whole, trace, trace_written, ratio_visible, ratio_written;
};

void run_round(const SampleGrid& grid, Sides& sides, Times& times) {
    const PreparedScene::Data& data = sides.prepared.data();
    const auto draw_all = [&](auto&& ask) {
        for (View& v : sides.views) {
            KernelScene scene{&data, &data.leaves, &v.mesh, &grid, &v.tiles};
            ask(v, scene);
            draw_tiles(scene, {});
        }
    };
    const auto visible = [&] {
        draw_all([](View& v, KernelScene& scene) { scene.vector_visible = v.vector_visible; });
    };
    const auto draw_written = [&] {
        draw_all([&](View&, KernelScene& scene) { scene.hits = sides.hits.ours; });
    };
    const auto draw_whole = [&] {
        for (View& v : sides.views) draw(sides.prepared, v.mesh, v.owned, grid, sides.hits.ours);
    };
    const auto trace = [&] {
        for (View& v : sides.views) sides.tracer.trace_in_order(v.packets, v.packet_hits);
    };
    const auto trace_written = [&] {
        for (View& v : sides.views) sides.tracer.trace(v.packets, sides.hits.theirs);
    };
    // There and back, so that a slow change of the machine's speed cancels.
    const double s1 = milliseconds(visible), t1 = milliseconds(trace), t2 = milliseconds(trace),
                 s2 = milliseconds(visible);
    const double v1 = milliseconds(trace_written), w1 = milliseconds(draw_written),
                 w2 = milliseconds(draw_written), v2 = milliseconds(trace_written);
    times.whole.push_back(milliseconds(draw_whole));
    times.trace.insert(times.trace.end(), {t1, t2});
    times.trace_written.insert(times.trace_written.end(), {v1, v2});
    times.written.insert(times.written.end(), {w1, w2});
    times.visible.insert(times.visible.end(), {s1, s2});
    times.ratio_visible.push_back((t1 + t2) / (s1 + s2));
    times.ratio_written.push_back((v1 + v2) / (w1 + w2));
}

/// How the projector draws the views' samples.
void count_samples(const SampleGrid& grid, Sides& sides, RaceResult& result) {
    const PreparedScene::Data& data = sides.prepared.data();
    std::size_t shared = 0;
    DrawCounts all;
    for (View& v : sides.views) {
        result.facets += v.tiles.rays.size();
        result.pixels += v.owned.sample.size();
        for (const MixedGroup& group : v.tiles.mixed)
            for (std::uint32_t i = group.first_vector; i < group.first_vector + group.vectors; ++i)
                shared += static_cast<std::size_t>(std::popcount(v.tiles.valid[i]));
        KernelScene scene{&data, &data.leaves, &v.mesh, &grid, &v.tiles};
        scene.vector_visible = v.vector_visible;
        const DrawCounts counts = draw_tiles(scene, {});
        all.ambiguous += counts.ambiguous;
        all.unbounded += counts.unbounded;
    }
    const auto share = [&](std::size_t samples) {
        return result.pixels == 0 ? 0 : static_cast<double>(samples) / static_cast<double>(result.pixels);
    };
    result.shared = share(shared);
    result.ambiguous = share(all.ambiguous);
    result.unbounded = share(all.unbounded);
}

/// Builds both sides several times over, then keeps one of each.
Sides make_sides(const RaceCourse& course, const RaceParams& params, RaceResult& result) {
    const PacketTracer::Options options{params.isa, false};
    std::vector<double> prepare, build, samples, rays;
    for (int i = 0; i < std::max(1, params.repeats / 3); ++i) {
        build.push_back(milliseconds([&] { PacketTracer(course.scene, options); }));
        prepare.push_back(milliseconds([&] { PreparedScene(course.scene); }));
        samples.push_back(milliseconds([&] {
            for (const RaceView& v : course.views)
                make_sample_tiles(*v.mesh, *v.owned, course.grid, tile_params(course.scene.size()));
        }));
        rays.push_back(milliseconds([&] {
            for (const RaceView& v : course.views) make_ray_packets(*v.mesh, *v.owned, course.grid);
        }));
    }
    result.prepare_ms = median(prepare);
    result.build_ms = median(build);
    result.samples_ms = median(samples);
    result.rays_ms = median(rays);
    Sides sides{PreparedScene(course.scene), PacketTracer(course.scene, options), {}, {}};
    sides.hits.ours.resize(course.grid.size());
    sides.hits.theirs.resize(course.grid.size());
    for (const RaceView& v : course.views)
        sides.views.push_back(make_view(v, course.grid, course.scene.size()));
    return sides;
}

}  // namespace

RaceResult race(const RaceCourse& course, const RaceParams& params) {
    check_course(course, params);
    RaceResult result;
    result.projector_isa = params.isa.empty() ? kernel_instruction_sets().front() : params.isa;
    const HeldSet held(params.isa);
    result.triangles = course.scene.size();
    result.threads = thread_count();
    Sides sides = make_sides(course, params, result);
    result.embree_configuration = sides.tracer.configuration();
    result.rays_at_once = sides.tracer.rays_at_once();

    Times times, warm_up;
    run_round(course.grid, sides, warm_up);
    for (int i = 0; i < params.repeats; ++i) run_round(course.grid, sides, times);
    result.visible_ms = median(times.visible);
    result.written_ms = median(times.written);
    result.whole_ms = median(times.whole);
    result.trace_ms = median(times.trace);
    result.trace_written_ms = median(times.trace_written);
    result.ratio.visible = median(times.ratio_visible);
    result.ratio.written = median(times.ratio_written);
    result.ratio.with_build =
        (result.trace_written_ms + result.build_ms) / (result.written_ms + result.prepare_ms);
    result.ratio.whole =
        (result.trace_written_ms + result.build_ms + result.rays_ms) / (result.whole_ms + result.prepare_ms);
    result.slowest_ratio = *std::min_element(times.ratio_written.begin(), times.ratio_written.end());
    result.fastest_ratio = *std::max_element(times.ratio_written.begin(), times.ratio_written.end());
    count_samples(course.grid, sides, result);
    result.depth_complexity = depth_complexity(course);
    for (View& view : sides.views) {
        draw(sides.prepared, view.mesh, view.owned, course.grid, sides.hits.ours);
        check_visible(view, sides.hits.ours);
        sides.tracer.trace(view.packets, sides.hits.theirs);
        for (const Id s : view.owned.sample) result.seen += sides.hits.ours[s].seen();
        explain(course, view, sides.hits, result.mismatches);
    }
    return result;
}

}  // namespace trilens_bench
