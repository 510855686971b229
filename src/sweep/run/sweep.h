// A sweep: plan, runs from picture to files, each drawn, timed, compared with its truth and kept; the truths, each
// traced once by whichever process or thread comes first.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/image/image.h"
#include "base/util/error.h"
#include "measure/displacement/image_finder.h"
#include "sweep/plan/plan.h"
#include "sweep/store/results.h"

namespace trilens {

struct SweepParams;
struct SweepCallbacks;

// The truths of a sweep: each traced once, by whichever process or thread comes first, and kept in the
// folder.

struct Truth {
    Image image;
    double seconds = 0;  // that tracing it took
};

/// A truth, and what measuring against it asks for again and again.
struct KeptTruth : Truth {
    explicit KeptTruth(Truth truth) : Truth(std::move(truth)), layers(image) {}
    ReferenceLayers layers;
};

/// Thread-safe. Keeps the truths that were asked for last in memory.
class TruthStore {
  public:
    TruthStore(std::string folder, std::function<Image(const PlannedRun& run)> trace, Progress progress)
        : folder_(std::move(folder)), trace_(std::move(trace)), progress_(std::move(progress)) {}

    /// The truth of this run: read where it is, else traced and kept. While another process or thread traces
    /// it: waits, or gives null where `may_wait` is false. Throws what the tracing throws, again for each run
    /// of a truth that failed; OutputError; Interrupted.
    std::shared_ptr<const KeptTruth> get(const PlannedRun& run, bool may_wait = true);

    /// How many truths stay in memory, at least 1.
    void set_kept(std::size_t count) { kept_count_ = count > 0 ? count : 1; }

  private:
    std::shared_ptr<const KeptTruth> find(const std::string& hash);
    std::shared_ptr<const KeptTruth> keep(const std::string& hash, Truth truth);
    std::shared_ptr<const KeptTruth> trace(const PlannedRun& run, const std::string& file);

    std::string folder_;
    std::function<Image(const PlannedRun& run)> trace_;
    Progress progress_;
    std::mutex mutex_;  // of what follows
    std::deque<std::pair<std::string, std::shared_ptr<const KeptTruth>>> kept_;
    std::map<std::string, std::exception_ptr> failures_;  // by hash
    std::size_t kept_count_ = 1;
};

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

// Sweeps: pictures at the points of some axes, each against its truth, and what the errors say together.
//
// A sweep's folder is its only memory. Every file is written beside its name and renamed; a run counts as
// finished once DONE holds its hash and the hashes of its files, so a sweep may stop anywhere and go on
// later. A folder belongs to one sweep. Any number of processes may be at it at once, with or without shards:
// each run, and each truth, is done by the process that holds the lock on its file.

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
