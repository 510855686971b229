#include "render/engines/certify_samples.h"
#include "render/engines/engine.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "projector/classic/classic.h"
#include "render/engines/fragment_keys.h"
#include "render/engines/path_ends.h"
#include "render/engines/rim_samples.h"
#include "render/frame/frame.h"

namespace trilens {
namespace {

constexpr std::size_t kLayersPerTask = 64;

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
class FacetViewer : public Viewer {
  public:
    FacetViewer(const World& world, Frame frame, const EngineChoice& engine, const WatchMesh& watch);

    void view(const SampleGrid& grid, SampleViews& views) override;
    bool has_facets() const override { return true; }
    const OpticPaths& paths(std::size_t optic) const override { return paths_[optic].paths(); }
    const RayMesh* camera_mesh() const override { return &frame_.camera.mesh; }
    const CameraModel* exact_camera() const override { return frame_.camera.model.get(); }
    void bound_coverage(const SampleGrid& grid, std::span<const Id> shown,
                        std::span<CoverageBounds> bounds) override;
    bool has_keys() const override { return has_keys_; }
    void find_keys(const SampleGrid& grid, std::span<FragmentKey> keys) override;
    void find_keys_of_pixels(const SampleGrid& grid, std::span<FragmentKey> keys) override;
    FragmentKey key_of(const SampleViews& views, const SampleView& view) const override;

  private:
    /// Along the camera's rays as far as its far plane.
    double reach() const { return frame_.camera.far_depth - frame_.camera.near_depth; }
    void make_paths(const EngineChoice& engine);
    void choose_drawers(const EngineChoice& engine, const WatchMesh& watch);
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
    double up_to_first(const SampleView& view) const;
    void view_layers_in_glass(SampleViews& views) const;
    void view_volumes(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const;
    void redraw_direct(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const;
    void describe_optic(std::size_t index, const Hit& hit, SampleView& view, OpticView& on_optic) const;

    const World& world_;
    Frame frame_;
    DrawMesh draw_first_;                // objects, for what lies before what
    DrawMesh draw_objects_;              // objects, as the engine shows them
    DrawMesh draw_paths_;                // the same, for the rays that leave optics
    std::vector<DrawMesh> draw_optics_;  // each optic's facets
    DrawVolumes draw_volumes_;           // unset: the world has none
    std::vector<SampleGrid> windows_;    // where they may be seen
    bool redraws_direct_ = false;        // draw_objects_ is another engine than draw_first_
    bool has_keys_ = false;
    OpticRims rims_;
    std::optional<CoverageBounder> coverage_;  // once it is asked for
    std::optional<NestedStage> stage_;

    // What views work out, and later ones find.
    std::vector<std::unique_ptr<NestedOptics>> nested_;  // per optic; null: it has none
    std::vector<PathBuilder> paths_;                     // per optic
    std::optional<SampleCertifier> certifier_;           // where proofs are asked for
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
    const SurfaceGrid& grid = frame_.optics[index].facets->grid();
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
    draw_first_(frame_.camera.mesh, owned, grid, hits);
    // Samples of no facet stay as they are made here; all others are set below.
    if (owned.sample.size() < grid.size())
        views.reset(grid.size());
    else
        views.restart(grid.size());
    for_each_camera_ray(frame_.camera.mesh, owned, grid, [&](Id s, Id facet, const Ray& ray) {
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
    const SurfaceGrid& grid = frame_.optics[index].facets->grid();
    const auto own = coincident_order(path_world(world_).optics[index],
                                      faces_front(grid, grid.facets[hit.triangle], view.ray.direction));
    const auto other =
        coincident_order(path_world(world_).optics[view.optic], views.on_optic(view).incidence.front);
    return own < other || (own == other && index < view.optic);
}

/// Whether the ray comes to a glass body's surface from inside: an object on which the body lies is seen
/// then.
bool FacetViewer::leaves_body(std::size_t index, const Hit& hit, const Ray& ray) const {
    const SurfaceGrid& grid = frame_.optics[index].facets->grid();
    return !world_.optics[index].mirror && !faces_front(grid, grid.facets[hit.triangle], ray.direction);
}

/// What a sample shows by now that it meets the optic, too.
void FacetViewer::meet_optic(std::size_t index, const Hit& hit, std::size_t sample,
                             SampleViews& views) const {
    SampleView& view = views.samples[sample];
    const bool sees_optic = view.optic != kNone, sees_object = view.hit.seen();
    if (rims_.limit != kAnyError && (sees_optic || sees_object)) {
        const MetSurface shown{view.optic, view.facet, view.depth};
        view.unsure = view.unsure || may_change_order({world_, frame_, rims_, reach()}, view.ray,
                                                      {static_cast<Id>(index), hit.triangle, hit.t}, shown);
    }
    if (sees_object && touches(hit.t, view.depth) && leaves_body(index, hit, view.ray)) return;
    if (sees_optic || sees_object) {
        const Id other = shown_mesh(world_, view);
        if (sees_optic && touches(hit.t, view.depth)) {
            if (!comes_first(index, hit, views, view)) return;
        } else if (!comes_before(hit.t, world_.optics[index].mesh, view.depth, other)) {
            return;
        }
    }
    describe_optic(index, hit, view, views.of_optics[sample]);
}

void FacetViewer::view_optic(std::size_t index, const FacetSamples& owned, const SampleGrid& grid,
                             SampleViews& views) const {
    const SampleGrid part = part_in(grid, windows_[index]);
    if (part.size() == 0) return;
    std::vector<Hit> hits(part.size());
    if (part.size() == grid.size())
        draw_optics_[index](frame_.camera.mesh, owned, part, hits);
    else
        draw_optics_[index](frame_.camera.mesh, rasterize_facets(frame_.camera.mesh, part), part, hits);
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
    if (rims_.limit != kAnyError) {
        decide_rims({world_, frame_, rims_, reach()}, grid, views);
        views.outline_error = rims_.error;
    }
    if (!grid.chosen.empty()) return;  // an area is that of all pixels
    for (std::size_t i = 0; i < rims_.edges.size(); ++i) {
        const auto shows = [&](const Vec2& at) {
            const std::size_t sample = grid.first_sample(static_cast<int>(at.x), static_cast<int>(at.y));
            return views.samples[sample].optic == i;
        };
        views.outline_pixels += outline_area(rims_.edges[i], rims_.limit, grid, shows);
    }
}

/// Where no optic is first, what the engine itself shows of the objects.
void FacetViewer::redraw_direct(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const {
    std::vector<Hit> hits(grid.size());
    draw_objects_(frame_.camera.mesh, owned, grid, hits);
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
    const auto met = decide_traced({world_, frame_, rims_, reach()}, grid, samples, views);
    std::vector<std::vector<TracedSample>> of_optic(frame_.optics.size());
    for (std::size_t i = 0; i < samples.size(); ++i)
        of_optic[views.samples[samples[i]].optic].push_back({samples[i], met[i]});
    for (std::size_t i = 0; i < of_optic.size(); ++i)
        trace_samples({world_, static_cast<Id>(i), paths_[i].context().camera, grid, reach(),
                       static_cast<bool>(draw_volumes_)},
                      of_optic[i], views, ends[i]);
    count_traced_from_eye(frame_.camera, grid, samples, views.samples);
}

/// Of t along a camera's ray: to what its sample shows first.
double FacetViewer::up_to_first(const SampleView& view) const {
    return view.hit.seen() || view.optic != kNone ? view.depth - frame_.camera.near_depth : reach();
}

/// Of a camera that stands in glass, what blends there.
void FacetViewer::view_layers_in_glass(SampleViews& views) const {
    if (!world_.blended || views.around.empty()) return;
    parallel_for(views.samples.size(), kLayersPerTask, [&](std::size_t from, std::size_t to) {
        for (std::size_t s = from; s < to; ++s) {
            const SampleView& view = views.samples[s];
            if (is_in_air(world_, views, view)) continue;
            const Material* glass = glass_around(world_, views.around_of(view));
            const double first = up_to_first(view);
            const bool has_end = view.optic == kNone || world_.optics[view.optic].mirror;
            views.volumes[s].first =
                trace_layers(world_, {view.ray, up_to_optic(view.ray, first, has_end), glass, false});
        }
    });
}

/// The camera's own rays through the volumes, up to what each sample shows first.
void FacetViewer::view_volumes(const FacetSamples& owned, const SampleGrid& grid, SampleViews& views) const {
    std::vector<double> until(grid.size());
    std::vector<VolumeLight> light(grid.size());
    for (std::size_t s = 0; s < until.size(); ++s) {
        const SampleView& view = views.samples[s];
        until[s] = is_in_air(world_, views, view) ? up_to_first(view) : 0;
    }
    draw_volumes_({frame_.camera.mesh, owned, grid, until}, light);
    for (std::size_t s = 0; s < until.size(); ++s) views.volumes[s].first = light[s];
    view_layers_in_glass(views);
}

void FacetViewer::view(const SampleGrid& grid, SampleViews& views) {
    const FacetSamples owned = rasterize_facets(frame_.camera.mesh, grid);
    view_objects(owned, grid, views);
    set_initial_media(frame_.camera_media, views);
    for (std::size_t i = 0; i < frame_.optics.size(); ++i) {
        frame_.stop_if_cancelled();
        view_optic(i, owned, grid, views);
    }
    view_rims(grid, views);
    if (redraws_direct_) redraw_direct(owned, grid, views);
    if (draw_volumes_) views.volumes.assign(grid.size(), SampleVolumes());
    count_from_eye(frame_.camera, views);
    std::vector<PathEnds> ends;
    ends.reserve(frame_.optics.size());
    std::vector<Id> traced;
    for (std::size_t i = 0; i < frame_.optics.size(); ++i) {
        frame_.stop_if_cancelled();
        ends.push_back(draw_optic_paths(
            {world_, static_cast<Id>(i), draw_paths_, draw_volumes_ ? &draw_volumes_ : nullptr,
             frame_.optics[i], nested_[i].get(), grid, part_in(grid, windows_[i])},
            paths_[i], views, traced));
        if (!certifier_) continue;
        certify_samples({*certifier_, frame_.optics[i].facets->grid(), grid, frame_.max_error}, views,
                        ends.back(), traced);
    }
    trace_each(traced, grid, views, ends);
    if (draw_volumes_) view_volumes(owned, grid, views);
    collect_ends(std::move(ends), views);
}

void FacetViewer::make_paths(const EngineChoice& engine) {
    const bool follows = follows_paths(engine.engine);
    if (follows) stage_ = make_nested_stage(world_, frame_);
    for (std::size_t i = 0; i < frame_.optics.size(); ++i) {
        nested_.push_back(stage_ ? make_nested_optics(world_, frame_, *stage_, i) : nullptr);
        paths_.push_back(follows ? make_optic_paths(world_, frame_, i, nested_[i].get())
                                 : make_approximate_paths(world_, frame_, i, engine.engine));
    }
    const bool has_limit = frame_.max_error > 0 && follows;
    if (frame_.certify && follows) certifier_.emplace(world_, frame_);
    rims_ = make_rims(world_, frame_, has_limit ? frame_.max_error : kAnyError);
}

void FacetViewer::choose_drawers(const EngineChoice& engine, const WatchMesh& watch) {
    const bool traces = engine.engine == Engine::kFacetsTruth;
    draw_first_ = traces ? trace_through(object_tracer(world_)) : project_through(prepared_objects(world_));
    draw_objects_ = draw_first_;
    for (const FramedOptic& optic : frame_.optics) {
        windows_.push_back(
            window_with_rim(rims_, windows_.size(), optic_window(optic, frame_.camera), frame_.camera.film));
        draw_optics_.push_back(traces ? trace_through(optic.facets->tracer())
                                      : project_through(optic.facets->prepared()));
    }
    if (engine.engine == Engine::kClassic) {
        draw_objects_ = classic_through(prepared_objects(world_), engine.classic);
        redraws_direct_ = true;
    }
    draw_paths_ = watch ? watched(watch, draw_objects_) : draw_objects_;
    if (has_layers(world_))
        draw_volumes_ = traces || world_.blended ? trace_layers(world_) : project_volumes(world_);
}

FacetViewer::FacetViewer(const World& world, Frame frame, const EngineChoice& engine, const WatchMesh& watch)
    : world_(world),
      frame_(std::move(frame)),
      has_keys_(projects(engine.engine) && engine.engine != Engine::kClassic) {
    make_paths(engine);
    choose_drawers(engine, watch);
}

void FacetViewer::bound_coverage(const SampleGrid& grid, std::span<const Id> shown,
                                 std::span<CoverageBounds> bounds) {
    std::fill(bounds.begin(), bounds.end(), CoverageBounds());
    if (redraws_direct_ || (rims_.limit != kAnyError && !frame_.optics.empty())) return;
    if (!coverage_) coverage_.emplace(world_, frame_, windows_);
    coverage_->bound(grid, shown, bounds);
}

void FacetViewer::find_keys(const SampleGrid& grid, std::span<FragmentKey> keys) {
    find_fragment_keys({world_, frame_, windows_, paths_, nested_, rims_}, grid, keys);
}

void FacetViewer::find_keys_of_pixels(const SampleGrid& grid, std::span<FragmentKey> keys) {
    find_pixel_keys({world_, frame_, windows_, paths_, nested_, rims_}, grid, keys);
}

FragmentKey FacetViewer::key_of(const SampleViews& views, const SampleView& view) const {
    const Id face =
        view.optic == kNone ? kNone : frame_.optics[view.optic].facets->grid().facet_face[view.facet];
    return fragment_key(views, view, face);
}

}  // namespace

std::unique_ptr<Viewer> make_facet_viewer(const World& world, Frame frame, const EngineChoice& engine,
                                          const WatchMesh& watch) {
    return std::make_unique<FacetViewer>(world, std::move(frame), engine, watch);
}

}  // namespace trilens
