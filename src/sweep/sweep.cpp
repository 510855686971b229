// Sweeps: the same scene at many resolutions against one truth, and what the errors say together.
#include "sweep/sweep.h"

#include <charconv>
#include <chrono>
#include <cstddef>
#include <map>
#include <new>
#include <optional>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/hash.h"
#include "image/image_io.h"
#include "sweep/csv.h"
#include "sweep/files.h"
#include "sweep/fit_runs.h"
#include "sweep/measure_run.h"
#include "sweep/results_json.h"
#include "sweep/run_files.h"
#include "sweep/sweep_report.h"
#include "sweep/text.h"

namespace trilens {
namespace {

constexpr const char* kFormat =
    "trilens.sweep/1";  // part of every hash: raise it when what a run stores changes

class Stopwatch {
  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Hash of parts such that no two lists of parts read the same.
std::string hash_parts(const std::vector<std::string>& parts) {
    std::string text;
    for (const std::string& part : parts) text += std::to_string(part.size()) + ":" + part;
    return hash_text(text);
}

std::string run_id(int n) {
    const std::string digits = std::to_string(n);
    return "n" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

std::string truth_hash(const SweepCallbacks& callbacks) {
    return hash_parts(
        {kFormat, "truth", callbacks.truth_key.empty() ? callbacks.job_key : callbacks.truth_key});
}

std::vector<PlannedRun> make_plan(const SweepParams& params, const SweepCallbacks& callbacks) {
    std::vector<std::string> parts = {kFormat, truth_hash(callbacks), callbacks.job_key};
    for (const SweptOptic& optic : params.subject.optics) {
        parts.push_back(std::to_string(optic.object));
        parts.push_back(optic.name);
    }
    std::vector<PlannedRun> plan;
    for (const int n : params.axis.values) {
        std::vector<std::string> all = parts;
        all.push_back(params.axis.name + "=" + std::to_string(n));
        plan.push_back({run_id(n), n, hash_parts(all)});
    }
    return plan;
}

/// Optics whose names tell them apart from each other and from "all": where they do not, the object's id is
/// added.
std::vector<SweptOptic> distinct_optics(const std::vector<SweptOptic>& optics) {
    std::map<std::string, int> uses = {{"all", 1}};
    for (const SweptOptic& optic : optics) ++uses[optic.name];
    std::vector<SweptOptic> distinct = optics;
    for (SweptOptic& optic : distinct)
        if (uses[optic.name] > 1) optic.name += " #" + std::to_string(optic.object);
    return distinct;
}

struct Truth {
    Image image;
    double seconds = 0;
};

/// The truth of this sweep: read where it is, else traced and kept.
Truth get_truth(const std::string& folder, const SweepCallbacks& callbacks) {
    const std::string file = truth_file(folder, truth_hash(callbacks)), seconds_file = file + ".seconds";
    if (const std::optional<std::string> text = read_whole_file(seconds_file)) {
        double seconds = 0;
        const auto end = std::from_chars(text->data(), text->data() + text->size(), seconds);
        // A truth that cannot be read is traced again.
        try {
            if (end.ec == std::errc()) return {read_exr(file), seconds};
        } catch (const InputError&) {
        }
    }
    const Stopwatch watch;
    Truth truth{callbacks.trace(), 0};
    truth.seconds = watch.seconds();
    write_exr(file, truth.image);
    replace_text_file(seconds_file, shortest_text(truth.seconds) + "\n");
    return truth;
}

/// "trilens:facets" of the header, where render says it.
std::optional<double> facet_count(const Image& image) {
    const auto found = image.metadata.find("trilens:facets");
    double count = 0;
    if (found == image.metadata.end()) return std::nullopt;
    const std::string& text = found->second;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), count);
    return end.ec == std::errc() ? std::optional(count) : std::nullopt;
}

struct DrawnRun {
    Image image, diff;
};

/// Renders and measures one run into `run`; what goes wrong there is the run's failure, and then there is no
/// picture.
std::optional<DrawnRun> draw_run(const SweepCallbacks& callbacks, const Truth& truth,
                                 const SweepSubject& subject, RunRecord& run) {
    run.state = RunState::kFailed;
    try {
        const Stopwatch watch;
        DrawnRun drawn{callbacks.render(run.plan.n), {}};
        const double seconds = watch.seconds();
        MeasuredRun measured = measure_run(drawn.image, truth.image, subject.optics);
        drawn.diff = std::move(measured.diff);
        run.metrics = std::move(measured.metrics);
        run.displacement = std::move(measured.displacement);
        run.warnings = std::move(measured.warnings);
        run.metrics["t_total_s"] = seconds;
        run.metrics["t_trace_s"] = truth.seconds;
        run.metrics["width"] = drawn.image.width;
        run.metrics["height"] = drawn.image.height;
        if (const std::optional<double> facets = facet_count(drawn.image)) run.metrics["facets"] = *facets;
        run.state = RunState::kDone;
        return drawn;
    } catch (const Interrupted&) {
        throw;
    } catch (const Error& error) {
        run.exit_code = static_cast<int>(error.code());
        run.error = error.what();
    } catch (const std::bad_alloc&) {
        run.exit_code = static_cast<int>(ExitCode::kComputation);
        run.error = "out of memory";
    }
    return std::nullopt;
}

RunRecord do_run(const SweepParams& params, const SweepCallbacks& callbacks, const Truth& truth,
                 const PlannedRun& plan) {
    clear_run(params.folder, plan);
    RunRecord run;
    run.plan = plan;
    const std::optional<DrawnRun> drawn = draw_run(callbacks, truth, params.subject, run);
    if (drawn) return store_run(params.folder, std::move(run), drawn->image, drawn->diff);
    store_failure(params.folder, run);
    return run;
}

/// Runs the shard's part of the plan. Throws Interrupted between runs.
void run_plan(const SweepParams& params, const SweepCallbacks& callbacks,
              const std::vector<PlannedRun>& plan) {
    std::optional<Truth> truth;
    for (std::size_t job = 0; job < plan.size(); ++job) {
        params.progress(static_cast<double>(job) / static_cast<double>(plan.size()));
        if (!params.shard.has(job)) continue;
        if (params.progress.cancelled()) throw Interrupted();
        RunRecord run = load_run(params.folder, plan[job]);
        if (run.state != RunState::kDone) {
            if (!truth) truth = get_truth(params.folder, callbacks);
            run = do_run(params, callbacks, *truth, plan[job]);
        }
        if (params.on_run) params.on_run(run);
    }
    params.progress(1);
}

SweepParams with_distinct_optics(SweepParams params) {
    params.subject.optics = distinct_optics(params.subject.optics);
    return params;
}

std::vector<PlannedRun> write_plan(const SweepParams& params, const SweepCallbacks& callbacks) {
    TRILENS_CHECK(callbacks.render && callbacks.trace, "a sweep renders and traces");
    TRILENS_CHECK(params.shard.index >= 0 && params.shard.index < params.shard.count, "a shard of the plan");
    const std::vector<PlannedRun> plan = make_plan(params, callbacks);
    make_folder(params.folder + "/truth");
    make_folder(params.folder + "/runs");
    const SweepManifest manifest{params.subject, params.axis, truth_hash(callbacks)};
    replace_text_file(params.folder + "/manifest.json", manifest_text(manifest, plan));
    replace_text_file(params.folder + "/plan.jsonl", plan_text(plan, manifest.truth_hash));
    return plan;
}

void write_tables(const SweepSummary& summary) {
    replace_text_file(summary.folder + "/runs.csv", runs_csv(summary));
    replace_text_file(summary.folder + "/displacement.csv", displacement_csv(summary));
    replace_text_file(summary.folder + "/summary.json", summary_text(summary));
}

}  // namespace

void plan_sweep(const SweepParams& params, const SweepCallbacks& callbacks) {
    write_plan(params, callbacks);
}

SweepSummary run_sweep(const SweepParams& given, const SweepCallbacks& callbacks) {
    const SweepParams params = with_distinct_optics(given);
    const std::vector<PlannedRun> plan = write_plan(params, callbacks);
    try {
        run_plan(params, callbacks, plan);
    } catch (const Interrupted&) {
        if (params.shard.count == 1) write_tables(load_sweep(params.folder));
        throw;
    }
    return params.shard.count == 1 ? report_sweep(params.folder) : load_sweep(params.folder);
}

SweepSummary load_sweep(const std::string& folder) {
    SweepSummary summary;
    summary.folder = folder;
    summary.manifest = read_manifest(folder + "/manifest.json");
    for (const PlannedRun& plan : read_plan(folder + "/plan.jsonl"))
        summary.runs.push_back(load_run(folder, plan));
    summary.fits = fit_runs(summary.runs);
    return summary;
}

SweepSummary report_sweep(const std::string& folder) {
    SweepSummary summary = load_sweep(folder);
    write_tables(summary);
    write_sweep_report(summary);
    return summary;
}

}  // namespace trilens
