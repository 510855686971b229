// The truths of a sweep: each traced once, by whichever process comes first, and kept in the folder.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "base/image.h"
#include "base/progress.h"
#include "sweep/results.h"

namespace trilens {

struct Truth {
    Image image;
    double seconds = 0;  // that tracing it took
};

/// Holds the truth that was asked for last.
class TruthStore {
  public:
    TruthStore(std::string folder, std::function<Image(int n)> trace, Progress progress)
        : folder_(std::move(folder)), trace_(std::move(trace)), progress_(std::move(progress)) {}

    /// The truth of this run: read where it is, else traced and kept; while another process traces it, waits.
    /// Valid until the next call. Throws what the tracing throws; OutputError; Interrupted.
    const Truth& get(const PlannedRun& run);

  private:
    std::string folder_;
    std::function<Image(int n)> trace_;
    Progress progress_;
    std::string hash_;
    std::optional<Truth> truth_;  // of hash_
};

}  // namespace trilens
