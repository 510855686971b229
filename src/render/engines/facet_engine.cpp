#include "render/engines/facet_engine.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "projector/classic/classic.h"
#include "render/engines/fragment_keys.h"
#include "render/engines/path_ends.h"
#include "render/engines/rim_samples.h"
#include "render/engines/trace_samples.h"
#include "render/frame/optic_window.h"

namespace trilens {
namespace {

DrawMesh project_through(const PreparedScene& scene) {
    return [&scene](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                    std::span<Hit> hits) { draw(scene, mesh, owned, grid, hits); };
}

DrawMesh trace_through(const Tracer& tracer) {
    return [&tracer](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                     std::span<Hit> hits) { trace_facets(tracer, mesh, owned, grid, hits); };
}

DrawMesh classic_through(const PreparedScene& scene, const ClassicParams& params) {
    return [&scene, params](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                            std::span<Hit> hits) { draw_classic(scene, mesh, owned, grid, hits, params); };
}

DrawMesh watched(const WatchMesh& watch, const DrawMesh& draw_mesh) {
    return [watch, draw_mesh](const RayMesh& mesh, const FacetSamples& owned, const SampleGrid& grid,
                              std::span<Hit> hits) {
        watch(mesh, owned, grid);
        draw_mesh(mesh, owned, grid, hits);
    };
}

/// All facet engines: the projectors and Embree on the same rays.
struct FacetViewer {
    const World* world = nullptr;
    Frame frame;
    DrawMesh draw_first;                // objects, for what lies before what
    DrawMesh draw_objects;              // objects, as the engine shows them
    DrawMesh draw_paths;                // the same, for the rays that leave optics
    std::vector<DrawMesh> draw_optics;  // each optic's facets
    std::vector<SampleGrid> windows;    // where they may be seen
    bool redraws_direct = false;        // draw_objects is another engine than draw_first
    std::optional<NestedStage> stage;
    std::vector<std::unique_ptr<NestedOptics>> nested;  // per optic; null: it has none
    std::vector<std::unique_ptr<OpticPaths>> paths;     // per optic
    OpticRims rims;

    void operator()(const SampleGrid& grid, SampleViews& views) const;

  private:
    /// Along the camera's rays as far as its far plane.
    double reach() const { return frame.camera.far_depth - frame.camera.near_depth; }
    void view_objects(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const;
    bool comes_first(std::size_t index, const Hit& hit, const SampleViews& views,
                     const SampleView& view) const;
    bool leaves_body(std::size_t index, const Hit& hit, const Ray& ray) const;
    void view_optic(std::size_t index, const FacetSamples& owned, const SampleGrid& grid,
                    SampleViews& views) const;
    void meet_optic(std::size_t index, const Hit& hit, std::size_t sample, SampleViews& views) const;
    void view_rims(const SampleGrid& grid, SampleViews& views) const;
    void trace_each(std::span<const Id> samples, const SampleGrid& grid, SampleViews& views,
                    std::vector<PathEnds>& ends) const;
    void redraw_direct(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const;
    void describe_optic(std::size_t index, const Hit& hit, SampleView& view, OpticView& on_optic) const;
};

/// As comes_before has it.
bool touches(double t, double than_t) {
    return std::fabs(t - than_t) <= kDepthTie * std::fabs(std::min(t, than_t));
}

Vec3 corner_weights(const Hit& hit) {
    return {1 - hit.barycentric.x - hit.barycentric.y, hit.barycentric.x, hit.barycentric.y};
}

void FacetViewer::describe_optic(std::size_t index, const Hit& hit, SampleView& view,
                                 OpticView& on_optic) const {
    const SurfaceGrid& grid = frame.optics[index].facets->grid();
    view.hit = {};
    view.depth = hit.t;
    view.optic = static_cast<Id>(index);
    view.facet = hit.triangle;
    on_optic = {};
    const Vec3 weights = corner_weights(hit);
    const IdTriple& corner = grid.facets[view.facet];
    Vec3 normal(0);
    for (int k = 0; k < 3; ++k) {
        const std::size_t c = static_cast<std::size_t>(k);
        normal += weights[k] * grid.corner_normal[corner[c]];
        on_optic.uv += weights[k] * grid.facet_uv[view.facet][c];
    }

    // The side is the facet's own; the angle that of the interpolated normal, grazing where it turned away.
    Incidence& incidence = on_optic.incidence;
    incidence.front = faces_front(grid, corner, view.ray.direction);
    const Vec3 unit = normalize_or_zero(normal) * (incidence.front ? 1.0 : -1.0);
    incidence.cosine = std::clamp(-dot(normalize_or_zero(view.ray.direction), unit), 0.0, 1.0);
    if (view.around != kNone) on_optic.way = hit.t * length(view.ray.direction);
}

/// Starts the views: the camera's rays, and what they see first of the objects.
void FacetViewer::view_objects(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const {
    std::vector<Hit> hits(grid.size());
    draw_first(frame.camera.mesh, owned, grid, hits);
    // Samples of no facet stay as they are made here; all others are set below.
    if (owned.sample.size() < grid.size())
        views.reset(grid.size());
    else
        views.restart(grid.size());
    for_each_camera_ray(frame.camera.mesh, owned, grid, [&](Id s, Id facet, const Ray& ray) {
        SampleView& view = views.samples[s];
        view = {};
        view.ray = ray;
        view.camera_facet = facet;
        if (!hits[s].seen() || hits[s].t > reach()) return;
        view.hit = hits[s];
        view.depth = hits[s].t;
    });
}

/// Of two optics that touch where a ray meets them, whether this one's turn comes before that of the one that
/// the sample shows so far.
bool FacetViewer::comes_first(std::size_t index, const Hit& hit, const SampleViews& views,
                              const SampleView& view) const {
    const SurfaceGrid& grid = frame.optics[index].facets->grid();
    const int own = coincident_order(world->optics[index].mirror,
                                     faces_front(grid, grid.facets[hit.triangle], view.ray.direction));
    const int other =
        coincident_order(world->optics[view.optic].mirror, views.on_optic(view).incidence.front);
    return own < other || (own == other && index < view.optic);
}

/// Whether the ray comes to a glass body's surface from inside: an object on which the body lies is seen
/// then.
bool FacetViewer::leaves_body(std::size_t index, const Hit& hit, const Ray& ray) const {
    const SurfaceGrid& grid = frame.optics[index].facets->grid();
    return !world->optics[index].mirror && !faces_front(grid, grid.facets[hit.triangle], ray.direction);
}

/// What a sample shows by now that it meets the optic, too.
void FacetViewer::meet_optic(std::size_t index, const Hit& hit, std::size_t sample,
                             SampleViews& views) const {
    SampleView& view = views.samples[sample];
    const bool sees_optic = view.optic != kNone, sees_object = view.hit.seen();
    if (rims.limit != kAnyError && (sees_optic || sees_object)) {
        const MetSurface shown{view.optic, view.facet, view.depth};
        view.unsure = view.unsure || may_change_order({*world, frame, rims, reach()}, view.ray,
                                                      {static_cast<Id>(index), hit.triangle, hit.t}, shown);
    }
    if (sees_object && touches(hit.t, view.depth) && leaves_body(index, hit, view.ray)) return;
    if (sees_optic || sees_object) {
        const Id other =
            sees_optic ? world->optics[view.optic].mesh : world->objects.object[view.hit.triangle];
        if (sees_optic && touches(hit.t, view.depth)) {
            if (!comes_first(index, hit, views, view)) return;
        } else if (!comes_before(hit.t, world->optics[index].mesh, view.depth, other)) {
            return;
        }
    }
    describe_optic(index, hit, view, views.of_optics[sample]);
}

void FacetViewer::view_optic(std::size_t index, const FacetSamples& owned, const SampleGrid& grid,
                             SampleViews& views) const {
    const SampleGrid part = part_in(grid, windows[index]);
    if (part.size() == 0) return;
    std::vector<Hit> hits(part.size());
    if (part.size() == grid.size())
        draw_optics[index](frame.camera.mesh, owned, part, hits);
    else
        draw_optics[index](frame.camera.mesh, rasterize_facets(frame.camera.mesh, part), part, hits);
    const std::size_t row = hits.size() / part.runs();
    parallel_for(part.runs(), 1024 / row, [&](std::size_t from, std::size_t to) {
        for (std::size_t y = from; y < to; ++y) {
            const std::size_t first = part.sample_in(grid, y * row);
            for (std::size_t x = 0; x < row; ++x) {
                const Hit& hit = hits[y * row + x];
                if (hit.seen() && hit.t <= reach()) meet_optic(index, hit, first + x, views);
            }
        }
    });
}

/// Where facets end elsewhere than the surface, what that shows; and what of the outlines is left as it is.
void FacetViewer::view_rims(const SampleGrid& grid, SampleViews& views) const {
    if (rims.limit != kAnyError) {
        decide_rims({*world, frame, rims, reach()}, grid, views);
        views.outline_error = rims.error;
    }
    if (!grid.chosen.empty()) return;  // an area is that of all pixels
    for (std::size_t i = 0; i < rims.edges.size(); ++i) {
        const auto shows = [&](const Vec2& at) {
            const std::size_t sample = grid.first_sample(static_cast<int>(at.x), static_cast<int>(at.y));
            return views.samples[sample].optic == i;
        };
        views.outline_pixels += outline_area(rims.edges[i], rims.limit, grid, shows);
    }
}

/// Where no optic is first, what the engine itself shows of the objects.
void FacetViewer::redraw_direct(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const {
    std::vector<Hit> hits(grid.size());
    draw_objects(frame.camera.mesh, owned, grid, hits);
    for (std::size_t s = 0; s < hits.size(); ++s) {
        SampleView& view = views.samples[s];
        if (view.optic != kNone) continue;
        view.hit = hits[s].seen() && hits[s].t <= reach() ? hits[s] : Hit();
        view.depth = view.hit.seen() ? view.hit.t : SampleView().depth;
    }
}

/// The ends of samples that no facet speaks for, by the optic that their exact rays meet first.
void FacetViewer::trace_each(std::span<const Id> samples, const SampleGrid& grid, SampleViews& views,
                             std::vector<PathEnds>& ends) const {
    const auto met = decide_traced({*world, frame, rims, reach()}, grid, samples, views);
    std::vector<std::vector<TracedSample>> of_optic(frame.optics.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
        of_optic[views.samples[samples[i]].optic].push_back({samples[i], met[i]});
    for (std::size_t i = 0; i < of_optic.size(); ++i)
        trace_samples({*world, static_cast<Id>(i), paths[i]->context().camera, grid}, of_optic[i], views,
                      ends[i]);
}

void FacetViewer::operator()(const SampleGrid& grid, SampleViews& views) const {
    const FacetSamples owned = rasterize_facets(frame.camera.mesh, grid);
    view_objects(owned, grid, views);
    set_initial_media(frame.camera_media, views);
    for (std::size_t i = 0; i < frame.optics.size(); ++i) view_optic(i, owned, grid, views);
    view_rims(grid, views);
    if (redraws_direct) redraw_direct(owned, grid, views);
    count_from_eye(frame.camera, views.samples);
    std::vector<PathEnds> ends;
    ends.reserve(frame.optics.size());
    std::vector<Id> traced;
    for (std::size_t i = 0; i < frame.optics.size(); ++i)
        ends.push_back(draw_optic_paths({*world, static_cast<Id>(i), draw_paths, frame.optics[i],
                                         nested[i].get(), grid, part_in(grid, windows[i])},
                                        *paths[i], views, traced));
    trace_each(traced, grid, views, ends);
    collect_ends(std::move(ends), views);
}

}  // namespace

Viewer make_facet_viewer(const World& world, Frame frame, const EngineChoice& engine) {
    return make_facet_views(world, std::move(frame), engine).viewer;
}

FacetViews make_facet_views(const World& world, Frame frame, const EngineChoice& engine,
                            const WatchMesh& watch) {
    auto viewer = std::make_shared<FacetViewer>();
    viewer->world = &world;
    viewer->frame = std::move(frame);
    if (follows_paths(engine.engine)) viewer->stage = make_nested_stage(world, viewer->frame);
    for (std::size_t i = 0; i < viewer->frame.optics.size(); ++i) {
        viewer->nested.push_back(viewer->stage ? make_nested_optics(world, viewer->frame, *viewer->stage, i)
                                               : nullptr);
        viewer->paths.push_back(follows_paths(engine.engine)
                                    ? make_optic_paths(world, viewer->frame, i, viewer->nested[i].get())
                                    : make_approximate_paths(world, viewer->frame, i, engine.engine));
    }
    const bool has_limit = viewer->frame.max_error > 0 && follows_paths(engine.engine);
    viewer->rims = make_rims(world, viewer->frame, has_limit ? viewer->frame.max_error : kAnyError);
    const bool traces = engine.engine == Engine::kFacetsTruth;
    viewer->draw_first =
        traces ? trace_through(object_tracer(world)) : project_through(prepared_objects(world));
    viewer->draw_objects = viewer->draw_first;
    for (const FramedOptic& optic : viewer->frame.optics) {
        viewer->windows.push_back(window_with_rim(viewer->rims, viewer->windows.size(),
                                                  optic_window(optic, viewer->frame.camera),
                                                  viewer->frame.camera.film));
        viewer->draw_optics.push_back(traces ? trace_through(optic.facets->tracer())
                                             : project_through(optic.facets->prepared()));
    }
    if (engine.engine == Engine::kClassic) {
        viewer->draw_objects = classic_through(prepared_objects(world), engine.classic);
        viewer->redraws_direct = true;
    }
    viewer->draw_paths = watch ? watched(watch, viewer->draw_objects) : viewer->draw_objects;
    FacetViews views{[viewer](const SampleGrid& grid, SampleViews& seen) { (*viewer)(grid, seen); },
                     [viewer](std::size_t optic) -> const OpticPaths& { return *viewer->paths[optic]; },
                     &viewer->frame.camera.mesh,
                     viewer->frame.camera.model.get(),
                     {}};
    if (projects(engine.engine) && engine.engine != Engine::kClassic)
        views.keys = {[viewer](const SampleGrid& grid, std::span<FragmentKey> keys) {
                          find_fragment_keys({*viewer->world, viewer->frame, viewer->windows, viewer->paths,
                                              viewer->nested, viewer->rims},
                                             grid, keys);
                      },
                      [viewer](const SampleViews& seen, const SampleView& view) {
                          const Id face =
                              view.optic == kNone
                                  ? kNone
                                  : viewer->frame.optics[view.optic].facets->grid().facet_face[view.facet];
                          return fragment_key(seen, view, face);
                      }};
    return views;
}

}  // namespace trilens
