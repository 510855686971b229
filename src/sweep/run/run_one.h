// One run from its picture to its files: drawn, timed, compared with its truth, kept; the truths, each traced
// once by whichever process or thread comes first.
#pragma once

#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/image/image.h"
#include "base/util/progress.h"
#include "measure/displacement/reference_layers.h"
#include "sweep/run/sweep.h"
#include "sweep/store/results.h"

namespace trilens {

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

}  // namespace trilens
