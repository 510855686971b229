// Sweeps: pictures at the points of some axes, each against its truth, and what the errors say together.
//
// A sweep's folder is its only memory. Every file is written beside its name and renamed; a run counts as
// finished once DONE holds its hash and the hashes of its files, so a sweep may stop anywhere and go on
// later. A folder belongs to one sweep. Any number of processes may be at it at once, with or without shards:
// each run, and each truth, is done by the process that holds the lock on its file.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/progress.h"
#include "sweep/plan/plan.h"
#include "sweep/store/results.h"

namespace trilens {

/// A run's picture with what making it took, by stage: "surface", "prepare", "draw". The columns of runs.csv
/// are t_<stage>_s; what lies outside the stages named is in t_total_s alone.
struct DrawnPicture {
    Image image;
    std::map<std::string, double> seconds = {};
};

/// How pictures come about; the sweep knows nothing of scenes. Called from several threads at once where
/// SweepParams::jobs is above 1.
struct SweepCallbacks {
    std::function<RunKeys(const Coordinates& point)> keys;
    std::function<DrawnPicture(const PlannedRun& run)> render;
    std::function<Image(const PlannedRun& run)> trace;  // asked once for all runs of one RunKeys::truth
    std::function<double(const PlannedRun& run)> memory = {};  // bytes that the run needs; empty: none
    // Files that the points' pictures depend on, asked after the keys of all points; empty: none
    std::function<std::vector<std::string>()> inputs = {};
};

struct SweepParams {
    std::string folder;
    SweepSubject subject;
    SweepAxes axes;
    bool replace = false;  // first removes what the folder holds of this or another sweep
    Shard shard;      // with more than one, nothing is summed up: report_sweep does that once all are done
    int jobs = 1;     // runs that are done at once
    int repeats = 1;  // measured drawings of each picture; with more than one, one before them is t_first_s
    double memory_limit = 0;  // bytes that the runs at work may need together; 0: most of what is free
    Progress progress;
    std::function<void(const RunRecord& run)> on_run;  // after each run, finished before or now; may be empty
};

/// Writes manifest.json and plan.jsonl and runs nothing. Throws OutputError, and UsageError where the folder
/// belongs to another sweep: one of another scene, camera, kind of truth or other axes (their values are
/// free), where files that lie there or that are read would be written over, or two points have one name.
void plan_sweep(const SweepParams& params, const SweepCallbacks& callbacks);

/// Plans, runs what is not finished, then does what report_sweep does. A run whose render throws Error, or
/// whose image cannot be compared, is recorded as failed with its exit code, and the others go on; it is
/// tried again next time; so is one whose truth cannot be traced, unless that is the truth of all runs. Runs
/// that other processes do meanwhile are waited for. Runs of `folder` that are not in this plan stay and are
/// ignored. Throws what the trace of a truth that all runs share throws; as plan_sweep does; Interrupted once
/// params.progress says so or a callback throws it, after writing runs.csv and summary.json of what is there.
SweepSummary run_sweep(const SweepParams& params, const SweepCallbacks& callbacks);

/// What the folder says, with fits; writes nothing. Throws InputError where there is no plan in it.
SweepSummary load_sweep(const std::string& folder);

/// The same, and writes runs.csv, displacement.csv, summary.json, summary.tex, plots/ and report.html. Throws
/// InputError, OutputError.
SweepSummary report_sweep(const std::string& folder);

// Does the runs of a plan: several at once, beside other processes, within memory.

class KeptPictures;

/// Does the shard's part of the plan: first what nobody else is at, then what those have left. Runs of one
/// truth follow each other. Returns those that were done here, by id, as load_run would read them now. Throws
/// Interrupted between runs, and as run_sweep does. `pictures`: where given, takes those of the runs done.
std::map<std::string, RunRecord> run_plan(const SweepParams& params, const SweepCallbacks& callbacks,
                                          const std::vector<PlannedRun>& plan,
                                          KeptPictures* pictures = nullptr);

class MemoryGate {
  public:
    /// `limit`: bytes; 0 or less: none.
    explicit MemoryGate(double limit) : limit_(limit) {}

    /// Inside from its construction on.
    class Visit {
      public:
        Visit(MemoryGate& gate, double bytes) : gate_(gate), bytes_(bytes) {}
        ~Visit() { gate_.leave(bytes_); }
        Visit(const Visit&) = delete;
        Visit& operator=(const Visit&) = delete;

      private:
        MemoryGate& gate_;
        double bytes_;
    };

    /// Waits for room; who is alone is always let in. Throws Interrupted once `progress` says so.
    Visit enter(double bytes, const Progress& progress);

  private:
    void leave(double bytes);

    double limit_, inside_ = 0;
    int visitors_ = 0;
    std::mutex mutex_;
    std::condition_variable left_;
};

}  // namespace trilens
