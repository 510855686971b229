// One run from its picture to its files: drawn, timed, compared with its truth, kept.
#pragma once

#include <optional>

#include "sweep/run/sweep.h"
#include "sweep/run/truth_store.h"

namespace trilens {

class KeptPictures;

struct RunJob {
    const SweepParams& params;
    const SweepCallbacks& callbacks;
    TruthStore& truths;
    const PlannedRun& plan;
    bool shares_one_truth = false;     // with all runs: without it none can be done
    bool may_wait = true;              // for a truth that another process traces
    KeptPictures* pictures = nullptr;  // where given, takes those of the run
};

/// The run as it is kept now, finished or failed; none where its truth is in other hands and it may not wait.
/// The caller holds the run's lock. Throws what the trace of a truth that all share throws, OutputError,
/// Interrupted.
std::optional<RunRecord> do_run(const RunJob& job);

}  // namespace trilens
