// Sweeps: the same scene at many resolutions against one truth, and what the errors say together.
//
// A sweep's folder is its only memory. Every file is written beside its name and renamed; a run counts as
// finished once DONE holds its hash and the hashes of its files, so a sweep may stop anywhere and go on
// later. A folder belongs to one sweep. Any number of processes may be at it at once, with or without shards:
// each run, and each truth, is done by the process that holds the lock on its file.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/image.h"
#include "base/progress.h"
#include "sweep/results.h"

namespace trilens {

/// How pictures come about; the sweep knows nothing of scenes.
struct SweepCallbacks {
    std::function<Image(int n)> render;  // the projector's image at resolution n
    std::function<Image(int n)> trace;   // the truth of that image, the same size and layers
    std::string job_key;         // changes whenever render would: the resolved scene, the options, the code
    std::string truth_key;       // the same for trace; empty: job_key
    bool truth_per_run = false;  // trace depends on n; else it is asked once, and the runs share its image
};

struct SweepParams {
    std::string folder;
    SweepSubject subject;
    Axis axis;
    bool replace = false;  // first removes what the folder holds of this or another sweep
    Shard shard;  // with more than one, nothing is summed up: report_sweep does that once all are done
    Progress progress;
    std::function<void(const RunRecord& run)> on_run;  // after each run, finished before or now; may be empty
};

/// Writes manifest.json and plan.jsonl and runs nothing. Throws OutputError, and UsageError where the folder
/// belongs to another sweep: one of another scene, camera, kind of truth or axis (its values are free).
void plan_sweep(const SweepParams& params, const SweepCallbacks& callbacks);

/// Plans, runs what is not finished, then does what report_sweep does. A run whose render throws Error, or
/// whose image cannot be compared, is recorded as failed with its exit code, and the others go on; it is
/// tried again next time; so is one whose own truth (truth_per_run) cannot be traced. Runs that other
/// processes do meanwhile are waited for. Runs of `folder` that are not in this plan stay and are ignored.
/// Throws what the trace of a shared truth throws; as plan_sweep does; Interrupted once params.progress says
/// so or a callback throws it, after writing runs.csv and summary.json of what is there.
SweepSummary run_sweep(const SweepParams& params, const SweepCallbacks& callbacks);

/// What the folder says, with fits; writes nothing. Throws InputError where there is no plan in it.
SweepSummary load_sweep(const std::string& folder);

/// The same, and writes runs.csv, displacement.csv, summary.json, plots/*.svg and report.html. Throws
/// InputError, OutputError.
SweepSummary report_sweep(const std::string& folder);

}  // namespace trilens
