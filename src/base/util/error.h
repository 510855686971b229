// Runtime errors (input, output, usage, computation), one class per exit code; caught once, in the command.
#pragma once

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

}  // namespace trilens
