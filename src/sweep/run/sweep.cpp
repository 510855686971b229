// Sweeps: pictures at the points of some axes, each against its truth, and what the errors say together.
#include "sweep/run/sweep.h"

#include <cstddef>
#include <map>
#include <string>
#include <utility>

#include "base/files/file_bytes.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "sweep/report/fit_runs.h"
#include "sweep/report/report_text.h"
#include "sweep/report/sweep_pictures.h"
#include "sweep/report/sweep_report.h"
#include "sweep/run/run_plan.h"
#include "sweep/store/csv.h"
#include "sweep/store/results_json.h"
#include "sweep/store/run_files.h"
#include "sweep/store/sweep_folder.h"
#include "sweep/store/sweep_ownership.h"

namespace trilens {
namespace {

std::vector<PlannedRun> plan_of(const SweepParams& params, const SweepCallbacks& callbacks) {
    TRILENS_CHECK(callbacks.render && callbacks.trace && callbacks.keys, "a sweep renders and traces");
    TRILENS_CHECK(params.shard.index >= 0 && params.shard.index < params.shard.count, "a shard of the plan");
    return make_plan(params.axes, callbacks.keys);
}

FileLock claim(const SweepParams& params, const SweepCallbacks& callbacks,
               const std::vector<PlannedRun>& plan) {
    if (callbacks.inputs) require_inputs_apart(params.folder, plan, callbacks.inputs());
    if (params.replace) clear_folder(params.folder);
    return claim_folder(params.folder, {params.subject, params.axes}, plan, params.progress);
}

void write_tables(const SweepSummary& summary) {
    replace_text_file(summary.folder + "/runs.csv", runs_csv(summary));
    replace_text_file(summary.folder + "/displacement.csv", displacement_csv(summary));
    replace_text_file(summary.folder + "/summary.json", summary_text(summary));
    replace_text_file(summary.folder + "/summary.tex", summary_latex(summary));
}

/// `done`: runs by id whose files need not be read again.
SweepSummary load_sweep(const std::string& folder, std::map<std::string, RunRecord> done) {
    SweepSummary summary;
    summary.folder = folder;
    summary.manifest = read_manifest(folder + "/manifest.json");
    const std::vector<PlannedRun> plan = read_plan(folder + "/plan.jsonl", summary.manifest.axes);
    summary.runs.resize(plan.size());
    parallel_for(plan.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const auto known = done.find(plan[i].id);
            const bool is_same = known != done.end() && known->second.plan.hash == plan[i].hash;
            summary.runs[i] = is_same ? std::move(known->second) : load_run(folder, plan[i]);
        }
    });
    summary.fits = fit_runs(summary.manifest.axes, summary.runs);
    return summary;
}

void write_report_files(const SweepSummary& summary, KeptPictures* pictures = nullptr) {
    write_tables(summary);
    write_sweep_report(summary, pictures);
}

}  // namespace

void plan_sweep(const SweepParams& params, const SweepCallbacks& callbacks) {
    claim(params, callbacks, plan_of(params, callbacks));
}

SweepSummary run_sweep(const SweepParams& params, const SweepCallbacks& callbacks) {
    const std::vector<PlannedRun> plan = plan_of(params, callbacks);
    const FileLock user = claim(params, callbacks, plan);
    const bool is_whole = params.shard.count == 1;
    KeptPictures pictures(kMostBytesInPage);
    std::map<std::string, RunRecord> done;
    try {
        done = run_plan(params, callbacks, plan, is_whole ? &pictures : nullptr);
    } catch (const Interrupted&) {
        if (is_whole) write_tables(load_sweep(params.folder));
        throw;
    }
    SweepSummary summary = load_sweep(params.folder, std::move(done));
    if (is_whole) write_report_files(summary, &pictures);
    return summary;
}

SweepSummary load_sweep(const std::string& folder) {
    return load_sweep(folder, {});
}

SweepSummary report_sweep(const std::string& folder) {
    SweepSummary summary = load_sweep(folder);
    write_report_files(summary);
    return summary;
}

}  // namespace trilens
