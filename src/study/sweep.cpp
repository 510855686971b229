#include "study/sweep.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <system_error>

#include "base/description/digest.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "base/util/version.h"
#include "render/engines/engine.h"
#include "render/picture/picture.h"
#include "study/libraries.h"
#include "study/sweep_subjects.h"
#include "sweep/plan/plan.h"
#include "sweep/run/sweep.h"
#include "sweep/store/machine.h"

namespace trilens {
namespace {

// Estimates of what a run holds: pixels of its image, its truth and their difference with what encodes them;
// facets with their rays.
constexpr double kBytesPerPixel = 5 * 34 * 4, kBytesPerSample = 200, kBytesPerFacet = 600;

/// Everything one sweep needs, alive while it runs.
struct SweepJob {
    SweepParams params;
    SweepCallbacks callbacks;
    PointRequest base;
    Engine truth = Engine::kLimitTruth;
    std::unique_ptr<Subjects> subjects;
    SweepObserver observer;
    std::map<std::string, bool> warned;
    std::mutex mutex;  // of `warned` and of what it tells

    void warn(const std::string& message) {
        const std::lock_guard guard(mutex);
        if (observer.warn && warned.emplace(message, true).second) observer.warn(message);
    }
};

Engine truth_engine(const std::string& truth) {
    if (truth == "limit") return Engine::kLimitTruth;
    if (truth == "facets") return Engine::kFacetsTruth;
    throw UsageError("the truth is \"limit\" or \"facets\", not \"" + truth + "\"");
}

Shard shard_of(const std::string& text) {
    return parse_shard(text, [](const char* name) { return std::getenv(name); });
}

/// A file as seen from the sweep's folder, so that it is the same from wherever the sweep is called and after
/// both have moved.
std::string name_from(const std::string& folder, const std::string& file) {
    namespace fs = std::filesystem;
    // Absolute first: what is relative and not there yet would stay relative.
    const auto place = [](const std::string& name) {
        std::error_code unreadable;
        return fs::weakly_canonical(fs::absolute(name), unreadable);
    };
    return place(file).lexically_proximate(place(folder)).generic_string();
}

/// What tells the scene from others of the folder: its file and what is changed in it. One in memory by its
/// label, else by what it holds.
std::string scene_name(const SweepRequest& request, const SubjectFacts& facts) {
    if (request.loaded)
        return !request.loaded->label.empty() ? request.loaded->label
                                              : scene_title(*request.loaded) + " " + facts.digest;
    std::string name =
        request.scene.file.empty() ? "several scenes" : name_from(request.folder, request.scene.file);
    if (request.scene.resolution > 0) name += fmt::format(" resolution={}", request.scene.resolution);
    for (const SceneOverride& change : request.scene.overrides)
        name += fmt::format(" {}={}", change.pointer, change.value);
    return name;
}

SweepAxes axes_of(const SweepRequest& request) {
    SweepAxes axes{{}, request.zip};
    if (request.over.empty()) throw UsageError("a sweep needs an axis: --over AXIS=VALUES");
    for (const AxisRequest& asked : request.over) {
        std::string values;
        for (const std::string& value : asked.values) values += (values.empty() ? "" : ",") + value;
        const std::string where = "--over " + asked.axis + "=" + values;
        axes.axes.push_back(make_axis(find_axis_kind(asked.axis, where), asked, where, request.zip));
    }
    return axes;
}

const Axis* find_axis(const SweepAxes& axes, const std::string& name) {
    for (const Axis& axis : axes.axes)
        if (axis.kind.name == name) return &axis;
    return nullptr;
}

std::string texts_of(const Axis& axis) {
    std::string text;
    for (const AxisValue& value : axis.values) text += (text.empty() ? "" : ", ") + value.text;
    return text;
}

std::string title_of(const SweepRequest& request, const SweepAxes& axes) {
    if (!request.title.empty()) return request.title;
    const std::string file = request.loaded ? request.loaded->file : request.scene.file;
    if (!file.empty()) return std::filesystem::path(file).stem().string();
    if (request.loaded) return scene_title(*request.loaded);
    const Axis* const scenes = find_axis(axes, "scene");
    return scenes ? texts_of(*scenes) : "sweep";
}

SweepSubject subject_of(const SweepRequest& request, const SweepAxes& axes, const SubjectFacts& facts) {
    const std::vector<std::string> libraries = versions_underneath();
    const auto swept_or = [&](const char* name, const std::string& otherwise) {
        const Axis* const axis = find_axis(axes, name);
        return axis ? texts_of(*axis) : otherwise;
    };
    SweepSubject subject;
    subject.title = title_of(request, axes);
    subject.scene = swept_or("scene", request.loaded ? scene_title(*request.loaded) : request.scene.file);
    subject.scene_name = scene_name(request, facts);
    subject.scene_digest = facts.digest;
    subject.camera = find_axis(axes, "camera") ? "" : facts.camera;
    subject.method = swept_or("engine", engine_name(Engine::kExact));
    subject.truth = request.truth;
    subject.spp = facts.film.spp;
    for (const SweptOptic& optic : facts.optics)
        subject.mesh += (subject.mesh.empty() ? "" : " ") + optic.name;
    if (const Axis* const optics = find_axis(axes, "optic")) subject.mesh = texts_of(*optics);
    if (!request.command.empty()) subject.commands = {request.command};
    subject.versions = {{"trilens", kVersion},
                        {"ray tracing", libraries[0]},
                        {"surfaces", libraries[1]},
                        {"images", libraries[2]}};
    return subject;
}

// The structures are taken apart by all of their members: one that is added does not compile until it is
// named here. The camera stands beside them by its name.

void add(const LayerRequest& window, Digest& digest) {
    // How often pixels are shaded is no matter to truths: picture_key adds it.
    [[maybe_unused]] const auto& [x0, y0, x1, y1, layers, shown, shading] = window;
    TRILENS_CHECK(!shown, "pictures of sweeps hold light");
    digest.add_all(x0, y0, x1, y1, layers.size());
    for (const std::string& layer : layers) digest.add(layer);
}

void add(const FrameParams& frame, Digest& digest) {
    [[maybe_unused]] const auto& [camera, resolution, grid, rays, max_error, layered, facets, certify] =
        frame;
    const auto add_own = [&](const auto& own) {
        digest.add(own.has_value());
        if (own) digest.add(*own);
    };
    digest.add(resolution);
    add_own(grid);
    add_own(rays);
    add_own(max_error);
    add_own(layered);
    if (facets != FacetUse::kAll) digest.add(facets);  // keys of older sweeps stay
    if (certify) digest.add(certify);
}

void add(const EngineChoice& choice, Digest& digest) {
    const auto& [engine, classic] = choice;
    digest.add(engine);
    if (engine != Engine::kClassic) return;
    const auto& [curves, clip, pieces, tolerance] = classic;
    digest.add_all(curves, clip, pieces, tolerance);
}

std::string picture_key(const PictureRequest& picture) {
    [[maybe_unused]] const auto& [frame, engine, window, watch] = picture;
    Digest digest;
    add(frame, digest);
    add(engine, digest);
    add(window, digest);
    digest.add(window.shading);
    return digest.digits();
}

/// Of the exact surfaces' truth: it has no facets.
std::string window_key(const LayerRequest& window) {
    Digest digest;
    add(window, digest);
    return digest.digits();
}

/// The truth of run n's own facets is that run's alone; the limit surface is that of all resolutions.
RunKeys keys_of(SweepJob& job, const Coordinates& point) {
    const PointRequest request = request_at(job.base, point);
    const SubjectFacts& facts = sweepable_facts(*job.subjects, request);
    const std::string seen = code_digest() + "\n" + facts.camera + "\n" + facts.digest;
    const PictureRequest& picture = request.picture;
    check_engine(picture.frame, picture.engine.engine);
    const std::string of_truth =
        job.truth == Engine::kFacetsTruth ? picture_key(picture) : window_key(picture.layers);
    return {seen + "\n" + picture_key(picture), seen + "\n" + engine_name(job.truth) + "\n" + of_truth,
            facts.optics};
}

Picture draw(SweepJob& job, const PointRequest& request, const std::string& what, double* surface_seconds) {
    const auto subject = job.subjects->load(request);
    PictureRequest picture = request.picture;
    picture.frame.camera = subject->camera;
    // Where several are drawn at once, only the whole sweep says how far it is.
    Progress progress;
    if (job.observer.progress && job.params.jobs <= 1) progress = job.observer.progress(what);
    progress.cancel = job.params.progress.cancel;
    if (surface_seconds) *surface_seconds = subject->seconds;
    check_request(*subject->world, picture);
    return draw_picture(*subject->world, picture, progress, [&](const std::string& text) { job.warn(text); });
}

DrawnPicture render(SweepJob& job, const PlannedRun& run) {
    const PointRequest request = request_at(job.base, run.at);
    double surface = 0;
    Picture picture = draw(job, request, "render", &surface);
    return {std::move(picture.image),
            {{"surface", surface}, {"prepare", picture.prepare_seconds}, {"draw", picture.draw_seconds}}};
}

Image trace(SweepJob& job, const PlannedRun& run) {
    PointRequest request = request_at(job.base, run.at);
    request.picture.engine = job.truth;
    if (job.truth == Engine::kLimitTruth) request.picture.frame.resolution = 0;
    return draw(job, request, "trace", nullptr).image;
}

double memory_of(SweepJob& job, const PlannedRun& run) {
    const PointRequest request = request_at(job.base, run.at);
    const SubjectFacts& facts = job.subjects->facts(request);
    const double pixels = static_cast<double>(facts.film.width) * facts.film.height,
                 n = std::max(8, request.picture.frame.resolution);
    return pixels * (kBytesPerPixel + kBytesPerSample * facts.film.spp * facts.film.spp) +
           kBytesPerFacet * 2 * n * n * static_cast<double>(facts.faces);
}

std::unique_ptr<SweepJob> make_job(const SweepRequest& request, const SweepObserver& observer) {
    if (request.jobs < 1 || request.repeats < 1)
        throw UsageError("a sweep needs at least one job and one repeat");
    auto job = std::make_unique<SweepJob>();
    SweepJob* const at = job.get();
    job->truth = truth_engine(request.truth);
    job->observer = observer;
    job->params.folder = request.folder;
    job->params.axes = axes_of(request);
    job->params.shard = shard_of(request.shard);
    job->params.replace = request.replace;
    job->params.jobs = request.jobs;
    job->params.repeats = request.repeats;
    job->params.memory_limit = request.memory_limit;
    job->base.scene = request.scene;
    job->base.camera = request.camera;
    job->base.paths_start_here = request.scenes_folder;
    if (request.loaded) {
        job->base.scene = {};
        job->base.loaded = std::make_shared<const Scene>(*request.loaded);
    }
    job->subjects = std::make_unique<Subjects>([at](const std::string& text) { at->warn(text); },
                                               static_cast<std::size_t>(request.jobs) + 1);
    const Warn warn = [at](const std::string& text) { at->warn(text); };
    const std::vector<LeftOutScene> left_out =
        leave_out_scenes(job->params.axes, job->base, *job->subjects, warn);
    job->params.axes = axes_for_scene(job->params.axes, job->base, *job->subjects, warn);
    const std::vector<Coordinates> points = make_points(job->params.axes);
    job->params.subject = subject_of(request, job->params.axes,
                                     sweepable_facts(*job->subjects, request_at(job->base, points.at(0))));
    job->params.subject.left_out = left_out;
    if (observer.progress) job->params.progress = observer.progress("sweep of " + job->params.subject.title);
    job->callbacks.keys = [at](const Coordinates& point) { return keys_of(*at, point); };
    job->callbacks.render = [at](const PlannedRun& run) { return render(*at, run); };
    job->callbacks.trace = [at](const PlannedRun& run) { return trace(*at, run); };
    job->callbacks.inputs = [at, file = request.sweep_file] {
        std::vector<std::string> files = at->subjects->files();
        if (!file.empty()) files.push_back(file);
        return files;
    };
    job->callbacks.memory = [at](const PlannedRun& run) { return memory_of(*at, run); };
    return job;
}

}  // namespace

SweepSummary run_sweep(const SweepRequest& request, const SweepObserver& observer) {
    const std::unique_ptr<SweepJob> job = make_job(request, observer);
    SweepSummary summary = run_sweep(job->params, job->callbacks);
    if (summary.other_runs > 0)
        job->warn(
            fmt::format("{} holds {} finished {} of values that are not asked for this time: {} in the "
                        "folder, but in no table, plot or page",
                        summary.folder, summary.other_runs, summary.other_runs == 1 ? "run" : "runs",
                        summary.other_runs == 1 ? "it stays" : "they stay"));
    return summary;
}

std::optional<LeftOutScene> why_left_out(const SweepRequest& request) {
    // What is wrong with the request is wrong for every scene.
    axes_of(request);
    truth_engine(request.truth);
    shard_of(request.shard);
    std::string reason;
    try {
        const std::unique_ptr<SweepJob> job = make_job(request, {});
        for (const Coordinates& point : make_points(job->params.axes)) job->callbacks.keys(point);
        return std::nullopt;
    } catch (const InputError& error) {
        reason = error.what();
    } catch (const UsageError& error) {
        reason = error.what();
    }
    // What cannot be read at all is no matter of the axes.
    if (!request.loaded && !request.scene.file.empty()) load_scene(request.scene);
    return LeftOutScene{request.loaded ? scene_title(*request.loaded) : request.scene.file, reason};
}

SweepRequest read_sweep_file(const std::string& file, SweepRequest request) {
    const SweepFile sweep = read_sweep_file(file);
    const std::string folder = std::filesystem::path(file).parent_path().string();
    request.scenes_folder = folder;
    request.sweep_file = file;
    request.over = sweep.over;
    const auto is_scenes = [](const AxisRequest& axis) { return axis.axis == "scene"; };
    const bool has_scenes_axis = std::ranges::any_of(sweep.over, is_scenes);
    if (has_scenes_axis == !sweep.scenes.empty())
        throw InputError(file, has_scenes_axis ? "/scenes" : "",
                         has_scenes_axis ? "scenes are named here and by an axis" : "names no scenes");
    if (sweep.scenes.size() == 1)
        request.scene.file = (std::filesystem::path(folder) / sweep.scenes[0]).string();
    else if (!sweep.scenes.empty())
        request.over.insert(request.over.begin(), {"scene", sweep.scenes});
    request.zip = sweep.zip;
    if (!sweep.truth.empty()) request.truth = sweep.truth;
    if (!sweep.camera.empty()) request.camera = sweep.camera;
    if (!sweep.title.empty()) request.title = sweep.title;
    if (sweep.repeats > 0) request.repeats = sweep.repeats;
    for (const auto& [pointer, value] : sweep.set)
        request.scene.overrides.push_back({.pointer = pointer, .value = value, .set_by = file + ": /set"});
    if (request.title.empty()) request.title = std::filesystem::path(file).stem().string();
    // What is wrong with the axes is wrong with the file.
    try {
        truth_engine(request.truth);
        make_points(axes_of(request));
    } catch (const UsageError& error) {
        throw InputError(file, "/over", error.what());
    }
    return request;
}

void require_distinct_names(std::span<const std::string> scenes) {
    std::map<std::string, std::string> scene_of_name;
    for (const std::string& scene : scenes) {
        if (scene == "-")
            throw UsageError("a sweep reads its scenes more than once: name files, not - for standard input");
        const auto [known, is_new] =
            scene_of_name.emplace(std::filesystem::path(scene).stem().string(), scene);
        if (!is_new)
            throw UsageError("the scenes " + known->second + " and " + scene +
                             " have one name, and so one folder; sweep them into different ones");
    }
}

bool is_whole_sweep(const std::string& shard) {
    return shard_of(shard).count == 1;
}

std::string plan_sweep(const SweepRequest& request, const SweepObserver& observer) {
    const std::unique_ptr<SweepJob> job = make_job(request, observer);
    plan_sweep(job->params, job->callbacks);
    return job->params.folder + "/plan.jsonl";
}

}  // namespace trilens
