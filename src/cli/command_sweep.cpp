// trilens sweep: error against resolution, for one scene or for a gallery of scenes.
#include <trilens/stopwatch.h>
#include <trilens/sweep.h>

#include <algorithm>
#include <filesystem>
#include <map>

#include "cli/commands.h"
#include "cli/scene_options.h"
#include "terminal/format.h"

namespace trilens {
namespace {

struct SweepOptions {
    SceneOptions scene;
    std::vector<std::string> scenes;
    std::string over = "resolution=1..16:x2";
    std::string output;
    std::string truth = "limit";
    std::string shard = "0/1";
    bool replace = false;
};

std::string scene_name(const std::string& file) {
    return std::filesystem::path(file).stem().string();
}

/// The command line that makes a sweep again, without the parts that are defaults.
std::string command_line(const SweepOptions& options, const std::string& scene) {
    std::string line = "trilens sweep run " + scene + " --over " + options.over;
    if (options.truth != "limit") line += " --truth " + options.truth;
    if (!options.scene.camera.empty()) line += " --camera " + options.scene.camera;
    if (!options.scene.size.empty()) line += " --size " + options.scene.size;
    if (options.scene.spp > 0) line += " --spp " + std::to_string(options.scene.spp);
    for (const std::string& set : options.scene.set) line += " --set '" + set + "'";
    return line + " -o " + options.output;
}

Json optional_json(const std::optional<double>& value) {
    return value ? json_number(*value) : Json(nullptr);
}

Json fit_json(const SweepFit& fit) {
    return {{"optic", fit.optic},
            {"layer", fit.layer},
            {"metric", fit.metric},
            {"order", optional_json(fit.order)},
            {"constant", optional_json(fit.constant)},
            {"r2", optional_json(fit.r2)},
            {"n_for_1px", optional_json(fit.n_for_1px)},
            {"n_for_half_px", optional_json(fit.n_for_half_px)},
            {"coverage", optional_json(fit.coverage)}};
}

Json summary_json(const SweepSummary& summary) {
    Json json{{"folder", summary.folder},
              {"runs", summary.runs.size()},
              {"done", summary.count(RunState::kDone)},
              {"failed", summary.count(RunState::kFailed)},
              {"missing", summary.count(RunState::kMissing)},
              {"fits", Json::array()}};
    for (const SweepFit& fit : summary.fits) json["fits"].push_back(fit_json(fit));
    return json;
}

std::string fit_line(const SweepFit& fit) {
    std::string line =
        fmt::format("  {:<8} {:<14} {:<16} order {:5.2f}  constant {:8.4g}  r2 {:.4f}", fit.layer, fit.optic,
                    fit.metric, *fit.order, fit.constant.value_or(0), fit.r2.value_or(0));
    if (fit.coverage) line += fmt::format("  measured >= {:.1f} %", 100 * *fit.coverage);
    if (fit.n_for_1px)
        line += "  1 px at n = " + std::to_string(static_cast<long long>(std::ceil(*fit.n_for_1px)));
    if (fit.n_for_half_px)
        line += "  0.5 px at n = " + std::to_string(static_cast<long long>(std::ceil(*fit.n_for_half_px)));
    return line + "\n";
}

std::string summary_text(const SweepSummary& summary) {
    std::string text = summary.manifest.subject.title + ": " +
                       std::to_string(summary.count(RunState::kDone)) + " of " +
                       std::to_string(summary.runs.size()) + " runs done\n";
    for (const SweepFit& fit : summary.fits)
        if (fit.order && (fit.metric == "disp_mean_px" || fit.metric == "disp_mean_off_folds_px" ||
                          fit.metric == "disp_p50_px"))
            text += fit_line(fit);
    return text;
}

Answer answer_of(const std::vector<SweepSummary>& summaries, const std::string& report) {
    Answer answer;
    answer.fields["report"] = report.empty() ? Json(nullptr) : Json(report);
    answer.fields["sweeps"] = Json::array();
    for (const SweepSummary& summary : summaries) {
        answer.text += summary_text(summary);
        answer.fields["sweeps"].push_back(summary_json(summary));
        for (const RunRecord& run : summary.runs) {
            if (run.state != RunState::kFailed) continue;
            answer.code = ExitCode::kSomeJobsFailed;
            answer.text += "  n = " + std::to_string(run.plan.n) + " failed: " + run.error + "\n";
            answer.errors.push_back(summary.manifest.subject.title + ", n = " + std::to_string(run.plan.n) +
                                    ": " + run.error);
        }
    }
    if (summaries.size() == 1) answer.fields["fits"] = answer.fields["sweeps"][0]["fits"];
    if (!report.empty()) answer.text += report + "\n";
    return answer;
}

/// The folder of one of the scenes: the sweep's own, or one below it where there are several.
std::string folder_of(const SweepOptions& options, const std::string& scene) {
    return options.scenes.size() == 1 ? options.output : options.output + "/" + scene_name(scene);
}

/// Two scenes of one name would write over each other.
void require_distinct_names(const std::vector<std::string>& scenes) {
    std::map<std::string, std::string> scene_of_name;
    for (const std::string& scene : scenes) {
        const auto [known, is_new] = scene_of_name.emplace(scene_name(scene), scene);
        if (!is_new)
            throw UsageError("the scenes " + known->second + " and " + scene +
                             " have one name, and so one folder; sweep them into different ones");
    }
}

SweepRequest sweep_request(const SweepOptions& options, const std::string& scene) {
    SceneOptions one = options.scene;
    one.scene = scene;
    SweepRequest request;
    request.scene = scene_request(one);
    request.camera = options.scene.camera;
    request.over = options.over;
    request.truth = options.truth;
    request.shard = options.shard;
    request.folder = folder_of(options, scene);
    request.replace = options.replace;
    request.command = command_line(options, scene);
    return request;
}

Answer run(const SweepOptions& options, Console& console) {
    require_distinct_names(options.scenes);
    console.files().reads(options.scenes);
    if (options.scenes.size() > 1) require_no_sweep(options.output);
    std::vector<SweepSummary> summaries;
    for (const std::string& scene : options.scenes) {
        const Stopwatch watch;
        summaries.push_back(run_sweep(sweep_request(options, scene), sweep_talk(console)));
        console.note_stage("swept " + scene, watch);
    }
    // A shard sums up nothing: `sweep report` does once all are done.
    const bool is_whole = is_whole_sweep(options.shard);
    const std::string report = is_whole ? options.output + "/report.html" : "";
    if (is_whole && summaries.size() > 1) write_sweep_gallery(options.output, summaries);
    Answer answer = answer_of(summaries, report);
    answer.is_report = true;
    return answer;
}

Answer plan(const SweepOptions& options, Console& console) {
    Answer answer;
    answer.is_report = true;
    require_distinct_names(options.scenes);
    console.files().reads(options.scenes);
    for (const std::string& scene : options.scenes) {
        const std::string file = plan_sweep(sweep_request(options, scene), sweep_talk(console));
        answer.text += file + "\n";
        answer.fields["plans"].push_back(file);
    }
    return answer;
}

/// The folder itself, or those below it where a sweep of several scenes made it; in the order of their names.
std::vector<std::string> sweeps_in(const std::string& folder) {
    namespace fs = std::filesystem;
    std::error_code none;
    std::vector<std::string> found;
    if (!fs::exists(folder + "/manifest.json", none))
        for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none))
            if (fs::exists(entry->path() / "manifest.json", none)) found.push_back(entry->path().string());
    std::sort(found.begin(), found.end());
    // Nothing there: the sweep's own message says so.
    return found.empty() ? std::vector<std::string>{folder} : found;
}

std::vector<Option> sweep_options(SweepOptions& options) {
    return joined(
        {{{.names = "SCENES",
           .target = &options.scenes,
           .help = "scene files; several make a gallery",
           .offer = Offer::kScene,
           .is_required = true},
          {.names = "-o,--output",
           .target = &options.output,
           .help = "folder for the results",
           .value = "DIR",
           .offer = Offer::kFolder,
           .is_required = true},
          {.names = "--over",
           .target = &options.over,
           .help = "what is varied: resolution=1,2,4 or resolution=1..64:x2",
           .value = "AXIS"},
          {.names = "--truth",
           .target = &options.truth,
           .help = "what runs are compared with: the exact surface or the same facets, ray traced",
           .choices = {"limit", "facets"}},
          {.names = "--shard",
           .target = &options.shard,
           .help = "do part i of n only: i/n, or auto in a job array",
           .value = "i/n"},
          {.names = "--replace",
           .target = &options.replace,
           .help = "start the folder afresh, whatever sweep it holds (else another sweep's is refused)"}},
         scene_overrides(options.scene)});
}

Answer status(const std::string& folder) {
    std::vector<SweepSummary> summaries;
    for (const std::string& one : sweeps_in(folder)) summaries.push_back(load_sweep(one));
    return answer_of(summaries, folder);
}

Answer report(const std::string& folder) {
    std::vector<SweepSummary> summaries;
    for (const std::string& one : sweeps_in(folder)) summaries.push_back(report_sweep(one));
    if (summaries.size() > 1) write_sweep_gallery(folder, summaries);
    return answer_of(summaries, folder + "/report.html");
}

Command folder_command(const std::string& name, const std::string& summary,
                       Answer (*body)(const std::string& folder)) {
    auto folder = std::make_shared<std::string>();
    return {.name = name,
            .summary = summary,
            .options = {{.names = "DIR",
                         .target = folder.get(),
                         .help = "the sweep's folder",
                         .offer = Offer::kFolder,
                         .is_required = true}},
            .schema = "sweep",
            .body = [folder, body](Console&) { return body(*folder); }};
}

}  // namespace

Command sweep_command() {
    auto options = std::make_shared<SweepOptions>();
    Command all{.name = "run",
                .summary = "do what is not done yet, then report",
                .options = sweep_options(*options),
                .schema = "sweep"};
    all.body = [options](Console& console) { return run(*options, console); };
    Command planned{.name = "plan",
                    .summary = "write the plan, run nothing",
                    .options = sweep_options(*options),
                    .schema = "sweep"};
    planned.body = [options](Console& console) { return plan(*options, console); };
    return {.name = "sweep",
            .summary = "render, trace and compare over resolutions",
            .commands = {std::move(all), std::move(planned), sweep_engines_command(),
                         folder_command("status", "what is done of a sweep", status),
                         folder_command("report", "sum up again: tables, fits, plots, page", report)}};
}

}  // namespace trilens
