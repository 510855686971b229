// What the command says on stderr: progress, warnings, errors; never on stdout.
#pragma once

#include <trilens/error.h>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <vector>

namespace trilens {

enum class ProgressStyle { kAuto, kBar, kPlain, kJson, kSilent };
enum class ColourStyle { kAuto, kAlways, kNever };

struct ConsoleOptions {
    bool quiet = false;  // errors only
    int verbose = 0;
    ProgressStyle progress = ProgressStyle::kAuto;
    ColourStyle colour = ColourStyle::kAuto;
    bool wants_json = false;  // the answer's fields will be read
};

/// One writer for everything on stderr, so that a bar and a message never mix. Keeps the warnings for the
/// JSON answer.
class Console {
  public:
    explicit Console(const ConsoleOptions& options);
    ~Console();

    void warn(const std::string& message);
    void error(const std::string& message);
    void note(const std::string& message);  // only with -v

    /// A Progress that draws `job` here: a bar on a terminal, else a line every 10 % or 30 s.
    Progress progress(const std::string& job);
    Warn warner() {
        return [this](const std::string& message) { warn(message); };
    }

    const std::vector<std::string>& warnings() const { return warnings_; }
    bool wants_json() const { return options_.wants_json; }

  private:
    void draw(const std::string& job, double done);
    void clear_bar();
    void write_line(const char* label, const char* colour, const std::string& message);

    ConsoleOptions options_;
    bool colour_ = false;
    bool bar_shown_ = false;
    double last_done_ = -1;
    std::chrono::steady_clock::time_point last_time_, started_;
    std::vector<std::string> warnings_;
    std::mutex mutex_;
};

/// Installs handlers of SIGINT and SIGTERM that set the flag below; a second signal ends the program at once.
void install_signal_handlers();

/// Set once a signal asked the program to stop.
const std::atomic<bool>& stop_requested();

/// 130 after SIGINT, 143 after SIGTERM.
int stop_exit_code();

}  // namespace trilens
