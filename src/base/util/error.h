// Runtime errors (input, output, usage, computation), one class per exit code; caught once, in the command.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>

namespace trilens {

/// Exit codes of the command (interface: "Command").
enum class ExitCode {
    kDone = 0,
    kExceeded = 1,
    kUsage = 2,
    kInput = 3,
    kOutput = 4,
    kComputation = 5,
    kSomeJobsFailed = 6,
    kSkipped = 77,
    kInterrupted = 130,
    kTerminated = 143
};

/// A failure that is not a bug. what() is one line: "file: place: message", parts that are empty left out.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& file, const std::string& place, const std::string& message);
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

/// `text` as the one line that an Error's message is: control characters become spaces, and those at its end
/// go.
std::string one_line(std::string text);

/// The command line asks for something that does not exist or makes no sense (exit 2).
class UsageError : public Error {
  public:
    explicit UsageError(const std::string& message) : Error(ExitCode::kUsage, "", "", message) {}
};

/// Input cannot be used (exit 3). `place` is a JSON pointer, "line 12", a channel name, or empty.
class InputError : public Error {
  public:
    InputError(const std::string& file, const std::string& place, const std::string& message)
        : Error(ExitCode::kInput, file, place, message) {}
};

/// Output cannot be written (exit 4).
class OutputError : public Error {
  public:
    OutputError(const std::string& file, const std::string& message)
        : Error(ExitCode::kOutput, file, "", message) {}
};

/// The computation itself failed, for example with non-finite pixels (exit 5).
class ComputationError : public Error {
  public:
    explicit ComputationError(const std::string& message) : Error(ExitCode::kComputation, "", "", message) {}
};

/// Thrown by long work once its Progress says so (exit 130).
class Interrupted : public Error {
  public:
    Interrupted() : Error(ExitCode::kInterrupted, "", "", "interrupted") {}
};

// How long work says how far it is, and learns that it should stop; seconds of wall-clock time.

/// Handed down into long work; default: silent and never cancelled.
struct Progress {
    // Share done, 0..1; never called from two threads at once, nor once cancelled.
    std::function<void(double done)> report;
    const std::atomic<bool>* cancel = nullptr;  // set by a signal handler
    // Told what is done from now on, at a speed of its own, until that share is done; the empty text: the job
    // itself, until its end.
    std::function<void(const std::string& what, double until)> stage = {};

    void operator()(double done) const {
        if (report && !cancelled()) report(done);
    }
    bool cancelled() const { return cancel && cancel->load(std::memory_order_relaxed); }
    void stop_if_cancelled() const {
        if (cancelled()) throw Interrupted();
    }
    void begin_stage(const std::string& what, double until = 1) const {
        if (stage && !cancelled()) stage(what, until);
    }
    /// Of this job's progress the part of that length from there on: what it is told is a share of the part.
    Progress part(double from, double length) const {
        Progress one = *this;
        if (report) one.report = [whole = report, from, length](double done) { whole(from + length * done); };
        if (stage)
            one.stage = [whole = stage, from, length](const std::string& what, double until) {
                whole(what, from + length * until);
            };
        return one;
    }
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

/// How much work is done between two reports: twice as much as before while that takes no time.
class Portions {
  public:
    Portions(std::size_t first, std::size_t most) : size_(first), most_(most) {}

    /// How much of what is left comes next; called before each portion.
    std::size_t next(std::size_t left) {
        constexpr double kNoTime = 0.05;  // seconds
        if (has_begun_ && watch_.seconds() < kNoTime) size_ = size_ < most_ / 2 ? 2 * size_ : most_;
        has_begun_ = true;
        watch_ = {};
        return left < size_ ? left : size_;
    }

  private:
    std::size_t size_, most_;
    bool has_begun_ = false;
    Stopwatch watch_;
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
