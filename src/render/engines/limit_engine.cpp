#include "render/engines/engine.h"

#include <algorithm>
#include <utility>

#include "base/raymesh/rasterize.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "base/util/parallel.h"
#include "render/engines/path_ends.h"
#include "render/frame/camera_rays.h"
#include "render/world/world.h"

namespace trilens {

void check_engine(const FrameParams& frame, Engine engine) {
    if (frame.max_error && (engine == Engine::kEnvironment || engine == Engine::kPlanar))
        throw UsageError(
            "an error that is asked for (--max-error) divides the facets of the exact engine, not of engine "
            "\"" +
            engine_name(engine) + "\"");
    // Proofs are of facets that stand for exact paths.
    if (frame.certify && (!follows_paths(engine) || engine == Engine::kLimitTruth))
        throw UsageError("what facets show is proven (certify), not what engine \"" + engine_name(engine) +
                         "\" draws");
}

std::unique_ptr<Viewer> make_viewer(const World& world, const FrameParams& frame, const EngineChoice& engine,
                                    const ViewerCallbacks& callbacks) {
    const Warn& warn = callbacks.warn;
    check_engine(frame, engine.engine);
    const bool exact = engine.engine == Engine::kLimitTruth;
    prepare_shadows(world, exact);
    if (has_caustics(world)) warn_of_lost_light(world, caustic_lights(world, exact), warn);
    if (engine.engine == Engine::kLimitTruth) {
        CameraRays camera = make_camera_rays(world.scene, frame.camera);
        warn_of_unsure_media(world, camera_media_of(world, camera), warn);
        return make_limit_viewer(world, std::move(camera));
    }
    FrameParams params = frame;
    if (engine.engine == Engine::kEnvironment || engine.engine == Engine::kPlanar)
        params.rays = CornerRays::kInterpolated;
    Frame placed = make_frame(world, params, warn);
    warn_of_unsure_media(world, placed.camera_media, warn);
    placed.cancel = callbacks.cancel;
    return make_facet_viewer(world, std::move(placed), engine);
}

std::string engine_name(Engine engine) {
    return name_of(engine);
}

const std::vector<std::string>& engine_names() {
    static const std::vector<std::string> names = names_of<Engine>();
    return names;
}

Engine find_engine(const std::string& name) {
    const std::optional<Engine> engine = find_named<Engine>(name);
    if (!engine) throw UsageError("there is no engine \"" + name + "\"" + suggestion(name, engine_names()));
    return *engine;
}

std::string classic_name(const ClassicParams& params) {
    std::string name = name_of(params.curves);
    if (params.curves == Curves::kSlices || params.curves == Curves::kTessellate)
        name += " " + std::to_string(params.pieces);
    if (params.clip != Clip::kScene) name += std::string(", clip ") + name_of(params.clip);
    return name;
}

namespace {

constexpr std::size_t kSamplesPerTask = 256;

/// What one task finds; put one after the other they do not depend on who did which.
struct Found {
    std::vector<PathEnd> ends;
    std::vector<Step> steps;
    FollowedPaths followed;  // of the last sample; empty at the end
};

class LimitViewer : public Viewer {
  public:
    LimitViewer(const World& world, CameraRays camera)
        : world_(world), camera_(std::move(camera)), camera_media_(camera_media_of(world, camera_)) {}

    void view(const SampleGrid& grid, SampleViews& views) override;
    bool has_facets() const override { return false; }
    const OpticPaths& paths(std::size_t) const override { has_none(); }
    const RayMesh* camera_mesh() const override { return camera_.model ? nullptr : &camera_.mesh; }
    const CameraModel* exact_camera() const override { return camera_.model.get(); }
    bool has_keys() const override { return false; }
    void find_keys(const SampleGrid&, std::span<FragmentKey>) override { has_none(); }
    void find_keys_of_pixels(const SampleGrid&, std::span<FragmentKey>) override { has_none(); }
    FragmentKey key_of(const SampleViews&, const SampleView&) const override { has_none(); }
    void bound_coverage(const SampleGrid&, std::span<const Id>, std::span<CoverageBounds> bounds) override {
        std::fill(bounds.begin(), bounds.end(), CoverageBounds());
    }

  private:
    [[noreturn]] static void has_none() {
        check_failed("has_facets()", __FILE__, __LINE__, "the limit truth has neither facets nor keys");
    }
    void view_sample(SampleView& view, OpticView& on_optic, const Media& around, Found& found,
                     SampleVolumes* volumes) const;

    const World& world_;
    CameraRays camera_;
    CameraMedia camera_media_;
    const PathWorld& paths_ = path_world(world_);
    const Tracer& objects_ = object_tracer(world_);
};

void LimitViewer::view_sample(SampleView& view, OpticView& on_optic, const Media& around, Found& found,
                              SampleVolumes* volumes) const {
    const double reach = camera_.far_depth - camera_.near_depth;
    const FirstSurface first = first_surface(paths_, objects_, view.ray, reach);
    view.hit = first.object;
    if (view.hit.seen()) view.depth = view.hit.t;
    if (volumes) {
        const Material* glass = glass_around(world_, around);
        const double until = first.optic != kNone ? up_to_optic(view.ray, first.at.t,
                                                                !glass || world_.optics[first.optic].mirror)
                             : view.hit.seen()    ? view.hit.t
                                                  : reach;
        volumes->first = trace_layers(world_, {view.ray, until, glass, !glass});
    }
    if (first.optic == kNone) return;
    view.optic = first.optic;
    view.depth = first.at.t;
    view.facet = first.at.face;
    on_optic = {};
    on_optic.uv = first.at.uv;
    on_optic.first_end = found.ends.size();
    follow_sample(world_, {first.at, around}, view,
                  {on_optic, found.ends, found.steps, found.followed, volumes});
    on_optic.end_count = found.ends.size() - on_optic.first_end;
}

void LimitViewer::view(const SampleGrid& grid, SampleViews& views) {
    views.reset(grid.size());
    FacetSamples owned;
    if (camera_.model) {
        owned = set_exact_rays(*camera_.model, grid, views.samples);
    } else {
        owned = rasterize_facets(camera_.mesh, grid);
        for_each_camera_ray(camera_.mesh, owned, grid, [&](Id s, Id facet, const Ray& ray) {
            views.samples[s].ray = ray;
            views.samples[s].camera_facet = facet;
        });
    }

    set_initial_media(camera_media_, views);
    if (has_layers(world_)) views.volumes.resize(grid.size());
    const std::size_t count = owned.sample.size();
    std::vector<Found> found((count + kSamplesPerTask - 1) / kSamplesPerTask);
    const auto samples_of = [&](std::size_t task) {
        const std::size_t first = task * kSamplesPerTask;
        return std::span(owned.sample).subspan(first, std::min(kSamplesPerTask, count - first));
    };
    parallel_for(found.size(), 1, [&](std::size_t from, std::size_t to) {
        for (std::size_t task = from; task < to; ++task) {
            for (const Id s : samples_of(task)) {
                SampleView& view = views.samples[s];
                view_sample(view, views.of_optics[s], views.around_of(view), found[task],
                            views.volumes.empty() ? nullptr : &views.volumes[s]);
            }
            found[task].followed = {};
        }
    });
    for (std::size_t task = 0; task < found.size(); ++task) {
        for (const Id s : samples_of(task))
            if (views.samples[s].optic != kNone) views.of_optics[s].first_end += views.ends.size();
        for (PathEnd& end : found[task].ends) end.first_step += views.steps.size();
        views.ends.insert(views.ends.end(), found[task].ends.begin(), found[task].ends.end());
        views.steps.insert(views.steps.end(), found[task].steps.begin(), found[task].steps.end());
    }
    count_from_eye(camera_, views);
}

}  // namespace

std::unique_ptr<Viewer> make_limit_viewer(const World& world, CameraRays camera) {
    return std::make_unique<LimitViewer>(world, std::move(camera));
}

}  // namespace trilens
