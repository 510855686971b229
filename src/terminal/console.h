// What the command says on stderr: progress, warnings, errors; never on stdout. And which files it reads and
// which it writes, so that no output is ever an input.
#pragma once

#include <trilens/error.h>
#include <trilens/utilities.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace trilens {

// Which files a command reads and which it writes, so that no output is ever an input.

/// "-" is standard input or output, and no file.
bool is_standard_stream(const std::string& file);

class FileRoles {
  public:
    /// Files that are read. Throws UsageError where one is an output already.
    void reads(const std::vector<std::string>& files);

    /// A file that will be written. Throws as check_writable does, and UsageError where it is an input or
    /// another output. The empty name and "-" are no files.
    void writes(const std::string& file);

    /// Whether one of the outputs is there already, and so may be an input.
    bool has_old_outputs() const;

    const std::vector<std::string>& inputs() const { return inputs_; }

  private:
    std::vector<std::string> inputs_, outputs_;
};

/// Whether two names are one file that exists, or one name.
bool is_one_file(const std::string& one, const std::string& other);

enum class ProgressStyle { kAuto, kBar, kPlain, kJson, kSilent };
enum class ColourStyle { kAuto, kAlways, kNever };

struct ConsoleOptions {
    bool quiet = false;  // errors only
    bool verbose = false;
    ProgressStyle progress = ProgressStyle::kAuto;
    ColourStyle colour = ColourStyle::kAuto;
    bool wants_json = false;          // the answer's fields will be read
    bool is_stdout_answered = false;  // by the JSON object: nothing else may go there
    std::vector<std::string> words;   // the command line behind the program's name
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
    /// With -v: what was done since the watch was started, and in how many seconds.
    void note_stage(const std::string& what, const Stopwatch& watch);

    /// A Progress that draws `job` here: a bar on a terminal, else a line every 10 % and where a
    /// stage begins, and where there was none for a twentieth of the time so far.
    Progress progress(const std::string& job);
    Warn warner() {
        return [this](const std::string& message) { warn(message); };
    }

    const std::vector<std::string>& warnings() const { return warnings_; }
    bool wants_json() const { return options_.wants_json; }
    bool is_stdout_answered() const { return options_.is_stdout_answered; }
    bool is_quiet() const { return options_.quiet; }
    const std::vector<std::string>& words() const { return options_.words; }
    FileRoles& files() { return files_; }
    const FileRoles& files() const { return files_; }

  private:
    void draw(const std::string& job, double done);
    void begin_stage(const std::string& what, double until);
    void clear_bar();
    void write_line(const char* label, const char* colour, const std::string& message);

    ConsoleOptions options_;
    bool colour_ = false;
    bool bar_shown_ = false;
    double last_done_ = -1, told_done_ = 0;  // that was drawn, and at all
    TimeLeft time_left_;                     // of the stage
    std::string stage_;
    double stage_from_ = 0, stage_until_ = 1;
    std::chrono::steady_clock::time_point last_time_, started_;
    std::vector<std::string> warnings_;
    FileRoles files_;
    std::mutex mutex_;
};

/// Installs handlers of SIGINT and SIGTERM. While a job reports its progress the first signal asks it to
/// stop, so that what was finished is kept; at other times, and at the second signal, the program ends at
/// once.
void install_signal_handlers();

/// Whether signals end the program at once: so it begins, and so it is while something may block for ever, as
/// reading a pipe. Console::progress() turns it off.
void stop_at_once(bool at_once);

/// What a program that ends at once prints on stdout, after SIGINT and after SIGTERM.
void set_last_words(const std::string& after_interrupt, const std::string& after_terminate);

/// Set once a signal asked the program to stop.
const std::atomic<bool>& stop_requested();

/// 130 after SIGINT, 143 after SIGTERM.
int stop_exit_code();

}  // namespace trilens
