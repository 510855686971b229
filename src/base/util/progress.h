// How long work says how far it is, and learns that it should stop; seconds of wall-clock time.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <string>

namespace trilens {

/// Handed down into long work; default: silent and never cancelled.
struct Progress {
    std::function<void(double done)> report;    // share done, 0..1, never called from two threads at once
    const std::atomic<bool>* cancel = nullptr;  // set by a signal handler

    void operator()(double done) const {
        if (report) report(done);
    }
    bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
};

/// Where rooms put what the user would want to know but what is no error.
using Warn = std::function<void(const std::string& message)>;

/// Runs from its construction on.
class Stopwatch {
  public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

  private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace trilens
