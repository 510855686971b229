// How long work says how far it is, and learns that it should stop; seconds of wall-clock time.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
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

/// How long work will still take, from the speed of what repeats: what was done before the first report
/// (facets made, rays fitted) is done once, and no measure of the rest.
class TimeLeft {
  public:
    /// Seconds left when the share `done` (0..1, growing) is done at `now` seconds; nothing before the second
    /// report of a share above 0, when no speed is known.
    std::optional<double> at(double done, double now) {
        if (done >= 1) return 0;
        if (!(done > 0)) return std::nullopt;
        if (!first_done_) {
            first_done_ = done;
            first_time_ = now;
        }
        if (!(done > *first_done_)) return std::nullopt;
        return (now - first_time_) * (1 - done) / (done - *first_done_);
    }

  private:
    std::optional<double> first_done_;
    double first_time_ = 0;
};

}  // namespace trilens
