#include "trilens/sweep.h"

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <system_error>

#include "base/error.h"
#include "base/format.h"
#include "sweep/code_digest.h"
#include "sweep/sweep.h"
#include "trilens/render.h"
#include "trilens/version.h"

namespace trilens {
namespace {

/// Everything one sweep needs, alive while it runs.
struct SweepJob {
    std::unique_ptr<Renderer> renderer;
    SweepParams params;
    SweepCallbacks callbacks;
};

Engine truth_engine(const std::string& truth) {
    if (truth == "limit") return Engine::kLimitTruth;
    if (truth == "facets") return Engine::kFacetsTruth;
    throw UsageError("the truth is \"limit\" or \"facets\", not \"" + truth + "\"");
}

Shard shard_of(const std::string& text) {
    return parse_shard(text, [](const char* name) { return std::getenv(name); });
}

/// What tells the scene from others of the folder: a file as seen from the folder, so that it is the same
/// from wherever the sweep is called and after both have moved, and what is changed in it. One in memory by
/// its label, else by what it holds.
std::string scene_name(const SweepRequest& request, const Renderer& renderer) {
    namespace fs = std::filesystem;
    if (request.loaded && !request.loaded->label.empty()) return request.loaded->label;
    if (request.loaded) return scene_title(*request.loaded) + " " + renderer.digest();
    std::error_code unreadable;
    const fs::path file = fs::weakly_canonical(request.scene.file, unreadable);
    const fs::path folder = fs::weakly_canonical(request.folder, unreadable);
    std::string name = file.lexically_proximate(folder).generic_string();
    if (request.scene.resolution > 0) name += fmt::format(" resolution={}", request.scene.resolution);
    for (const SceneOverride& change : request.scene.overrides)
        name += fmt::format(" {}={}", change.pointer, change.value);
    return name;
}

SweepSubject subject_of(const SweepRequest& request, const Renderer& renderer, std::size_t camera) {
    const std::vector<std::string> libraries = library_versions();
    SweepSubject subject;
    const Scene& scene = renderer.scene();
    subject.scene = scene_title(scene);
    subject.title = !request.title.empty() ? request.title
                    : scene.file.empty()   ? subject.scene
                                           : std::filesystem::path(scene.file).stem().string();
    subject.scene_name = scene_name(request, renderer);
    subject.scene_digest = renderer.digest();
    subject.camera = renderer.scene().cameras[camera].name;
    subject.method = engine_name(Engine::kExact);
    subject.truth = request.truth;
    subject.spp = renderer.scene().film.spp;
    for (const OpticInfo& optic : renderer.optics()) {
        subject.optics.push_back({optic.object, optic.name});
        subject.mesh += (subject.mesh.empty() ? "" : " ") + optic.name;
    }
    if (!request.command.empty()) subject.commands = {request.command};
    subject.versions = {{"trilens", version()},
                        {"ray tracing", libraries[0]},
                        {"surfaces", libraries[1]},
                        {"images", libraries[2]}};
    return subject;
}

std::unique_ptr<SweepJob> make_job(const SweepRequest& request, const SweepTalk& talk) {
    const Engine truth = truth_engine(request.truth);
    auto job = std::make_unique<SweepJob>();
    job->params.folder = request.folder;
    job->params.axis = parse_axis(request.over);
    job->params.shard = shard_of(request.shard);
    job->params.replace = request.replace;

    Scene scene = request.loaded ? *request.loaded : load_scene(request.scene);
    if (talk.warn && !request.loaded)
        for (const std::string& warning : scene.warnings) talk.warn(warning);
    const std::size_t camera = find_camera(scene, request.camera);
    job->renderer = std::make_unique<Renderer>(std::move(scene), talk.warn);
    if (job->renderer->optics().empty())
        throw InputError(scene_title(job->renderer->scene()), "/meshes",
                         "a sweep needs an optic whose resolution it can vary");

    job->params.subject = subject_of(request, *job->renderer, camera);
    if (talk.progress) job->params.progress = talk.progress("sweep of " + job->params.subject.title);
    const auto draw = [renderer = job->renderer.get(), camera, talk](Engine engine, int n) {
        PictureRequest picture;
        picture.frame = {camera, n};
        picture.engine = engine;
        Progress progress;
        if (talk.progress) progress = talk.progress(engine == Engine::kExact ? "render" : "trace");
        return renderer->draw(picture, progress, talk.warn).image;
    };
    job->callbacks.render = [draw](int n) { return draw(Engine::kExact, n); };
    // The facets of run n are the truth of run n alone; the limit surface is that of all.
    job->callbacks.truth_per_run = truth == Engine::kFacetsTruth;
    job->callbacks.trace = [draw, truth](int n) {
        return draw(truth, truth == Engine::kFacetsTruth ? n : 0);
    };
    // The text too: every picture carries it.
    job->callbacks.job_key = code_digest() + "\n" + job->params.subject.camera + "\n" +
                             job->renderer->scene().resolved + "\n" + job->renderer->digest();
    job->callbacks.truth_key = job->callbacks.job_key + "\n" + request.truth;
    return job;
}

}  // namespace

SweepSummary run_sweep(const SweepRequest& request, const SweepTalk& talk) {
    const std::unique_ptr<SweepJob> job = make_job(request, talk);
    return run_sweep(job->params, job->callbacks);
}

bool is_whole_sweep(const std::string& shard) {
    return shard_of(shard).count == 1;
}

std::string plan_sweep(const SweepRequest& request, const SweepTalk& talk) {
    const std::unique_ptr<SweepJob> job = make_job(request, talk);
    plan_sweep(job->params, job->callbacks);
    return job->params.folder + "/plan.jsonl";
}

}  // namespace trilens
