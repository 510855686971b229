// Lets work in as long as all that is inside fits into memory together.
#pragma once

#include <condition_variable>
#include <mutex>

#include "base/util/progress.h"

namespace trilens {

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
