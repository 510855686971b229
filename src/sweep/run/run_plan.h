// Does the runs of a plan: several at once, beside other processes, within memory.
#pragma once

#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "base/util/progress.h"
#include "sweep/run/sweep.h"

namespace trilens {

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
