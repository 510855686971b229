// Sweeps: the same scene at many resolutions against one truth, and what the errors say together.
#include "sweep/sweep.h"

#include <charconv>
#include <cstddef>
#include <map>
#include <new>
#include <optional>
#include <utility>

#include "base/check.h"
#include "base/error.h"
#include "base/files.h"
#include "base/parallel.h"
#include "base/stopwatch.h"
#include "sweep/csv.h"
#include "sweep/file_lock.h"
#include "sweep/fit_runs.h"
#include "sweep/measure_run.h"
#include "sweep/plan.h"
#include "sweep/results_json.h"
#include "sweep/run_files.h"
#include "sweep/sweep_folder.h"
#include "sweep/sweep_report.h"
#include "sweep/truth_store.h"

namespace trilens {
namespace {

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

/// What goes wrong in `work` is the run's failure.
void attempt(RunRecord& run, const std::function<void()>& work) {
    run.state = RunState::kFailed;
    try {
        work();
        run.state = RunState::kDone;
    } catch (const Interrupted&) {
        throw;
    } catch (const Error& error) {
        run.exit_code = static_cast<int>(error.code());
        run.error = error.what();
    } catch (const std::bad_alloc&) {
        run.exit_code = static_cast<int>(ExitCode::kComputation);
        run.error = "out of memory";
    }
}

/// Renders and measures one run into `run`.
DrawnRun draw_run(const SweepCallbacks& callbacks, const Truth& truth, const SweepSubject& subject,
                  RunRecord& run) {
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
    return drawn;
}

/// One process at its part of the plan.
struct Worker {
    const SweepParams& params;
    const SweepCallbacks& callbacks;
    TruthStore truths;
    std::map<std::string, std::string> failures;  // id -> failure_stamp, as the folder was at the start

    RunRecord do_run(const PlannedRun& plan) {
        RunRecord run;
        run.plan = plan;
        // Without the truth that all runs share none can be done; one of its own is a part of the run.
        if (!callbacks.truth_per_run) truths.get(plan);
        clear_run(params.folder, plan);
        DrawnRun drawn;
        attempt(run, [&] { drawn = draw_run(callbacks, truths.get(plan), params.subject, run); });
        if (run.state == RunState::kDone)
            return store_run(params.folder, std::move(run), drawn.image, drawn.diff);
        store_failure(params.folder, run);
        return run;
    }

    /// The caller holds the run's lock. A run that another process has tried since this one began is not
    /// tried again.
    void settle(const PlannedRun& plan) {
        RunRecord run = load_run(params.folder, plan);
        const bool is_tried =
            run.state == RunState::kFailed && failure_stamp(params.folder, plan) != failures[plan.id];
        if (run.state != RunState::kDone && !is_tried) run = do_run(plan);
        if (params.on_run) params.on_run(run);
    }
};

/// Runs the shard's part of the plan: first what no other process is at, then what those have left. Throws
/// Interrupted between runs.
void run_plan(const SweepParams& params, const SweepCallbacks& callbacks,
              const std::vector<PlannedRun>& plan) {
    Worker worker{params, callbacks, {params.folder, callbacks.trace, params.progress}, {}};
    std::vector<PlannedRun> mine, busy;
    for (std::size_t job = 0; job < plan.size(); ++job)
        if (params.shard.has(job)) mine.push_back(plan[job]);
    for (const PlannedRun& run : mine) worker.failures[run.id] = failure_stamp(params.folder, run);

    std::size_t settled = 0;
    const auto settle = [&](const PlannedRun& run) {
        worker.settle(run);
        params.progress(static_cast<double>(++settled) / static_cast<double>(mine.size()));
    };
    params.progress(0);
    for (const PlannedRun& run : mine) {
        if (params.progress.cancelled()) throw Interrupted();
        const std::optional<FileLock> lock = FileLock::try_lock(run_lock(params.folder, run), LockKind::kOne);
        if (lock)
            settle(run);
        else
            busy.push_back(run);
    }
    for (const PlannedRun& run : busy) {
        if (params.progress.cancelled()) throw Interrupted();
        const FileLock lock = FileLock::wait(run_lock(params.folder, run), LockKind::kOne, params.progress);
        settle(run);
    }
    params.progress(1);
}

SweepParams with_distinct_optics(SweepParams params) {
    params.subject.optics = distinct_optics(params.subject.optics);
    return params;
}

std::vector<PlannedRun> plan_of(const SweepParams& params, const SweepCallbacks& callbacks) {
    TRILENS_CHECK(callbacks.render && callbacks.trace, "a sweep renders and traces");
    TRILENS_CHECK(params.shard.index >= 0 && params.shard.index < params.shard.count, "a shard of the plan");
    const std::string& truth = callbacks.truth_key.empty() ? callbacks.job_key : callbacks.truth_key;
    return make_plan(params.axis, params.subject.optics, {callbacks.job_key, truth, callbacks.truth_per_run});
}

FileLock claim(const SweepParams& params, const std::vector<PlannedRun>& plan) {
    if (params.replace) clear_folder(params.folder);
    return claim_folder(params.folder, {params.subject, params.axis}, plan, params.progress);
}

void write_tables(const SweepSummary& summary) {
    replace_text_file(summary.folder + "/runs.csv", runs_csv(summary));
    replace_text_file(summary.folder + "/displacement.csv", displacement_csv(summary));
    replace_text_file(summary.folder + "/summary.json", summary_text(summary));
}

}  // namespace

void plan_sweep(const SweepParams& given, const SweepCallbacks& callbacks) {
    const SweepParams params = with_distinct_optics(given);
    claim(params, plan_of(params, callbacks));
}

SweepSummary run_sweep(const SweepParams& given, const SweepCallbacks& callbacks) {
    const SweepParams params = with_distinct_optics(given);
    const std::vector<PlannedRun> plan = plan_of(params, callbacks);
    const FileLock user = claim(params, plan);
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
    const std::vector<PlannedRun> plan = read_plan(folder + "/plan.jsonl");
    summary.runs.resize(plan.size());
    parallel_for(plan.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) summary.runs[i] = load_run(folder, plan[i]);
    });
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
