#include "terminal/console.h"

#include <trilens/error.h>
#include <trilens/utilities.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "terminal/libraries.h"

namespace trilens {
namespace {

std::atomic<bool> g_stop{false};
std::atomic<int> g_signal{0};

std::atomic<bool> g_at_once{true};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler reads it");
std::string g_after_interrupt, g_after_terminate;

/// All of `text`, as far as the descriptor takes it; only with what a signal handler may call.
void write_all(int descriptor, const char* text, std::size_t size) {
    while (size > 0) {
        const ssize_t written = write(descriptor, text, size);
        if (written <= 0) return;
        text += written;
        size -= static_cast<std::size_t>(written);
    }
}

[[noreturn]] void end_at_once(int signal) {
    constexpr char kSaid[] = "trilens: error: interrupted\n";
    remove_unfinished_files();
    const std::string& answer = signal == SIGTERM ? g_after_terminate : g_after_interrupt;
    write_all(STDOUT_FILENO, answer.data(), answer.size());
    write_all(STDERR_FILENO, kSaid, sizeof kSaid - 1);
    _exit(128 + signal);
}

void handle_signal(int signal) {
    if (g_stop.exchange(true) || g_at_once) end_at_once(signal);
    g_signal = signal;
}

/// A terminal that can redraw a line; build servers and files cannot.
bool is_live_terminal() {
    const char* term = std::getenv("TERM");
    return isatty(STDERR_FILENO) && !std::getenv("CI") && term && std::string(term) != "dumb";
}

}  // namespace

void install_signal_handlers() {
    std::signal(SIGINT, handle_signal);
    std::signal(SIGTERM, handle_signal);
    // A file that outgrows the user's limit is then a write that fails, as on a full disk.
    std::signal(SIGXFSZ, SIG_IGN);
}

void stop_at_once(bool at_once) {
    g_at_once = at_once;
}

void set_last_words(const std::string& after_interrupt, const std::string& after_terminate) {
    g_after_interrupt = after_interrupt;
    g_after_terminate = after_terminate;
}

const std::atomic<bool>& stop_requested() {
    return g_stop;
}

int stop_exit_code() {
    return g_signal == SIGTERM ? 143 : 130;
}

Console::Console(const ConsoleOptions& options) : options_(options) {
    if (options_.progress == ProgressStyle::kAuto)
        options_.progress = is_live_terminal() ? ProgressStyle::kBar : ProgressStyle::kPlain;
    if (options_.quiet) options_.progress = ProgressStyle::kSilent;
    colour_ = options_.colour == ColourStyle::kAlways ||
              (options_.colour == ColourStyle::kAuto && is_live_terminal() && !std::getenv("NO_COLOR"));
}

Console::~Console() {
    clear_bar();
}

void Console::clear_bar() {
    if (!bar_shown_) return;
    std::fputs("\r\033[K", stderr);
    bar_shown_ = false;
}

void Console::write_line(const char* label, const char* colour, const std::string& message) {
    clear_bar();
    if (colour_) {
        std::fprintf(stderr, "trilens: \033[%sm%s\033[0m%s\n", colour, label, message.c_str());
    } else {
        std::fprintf(stderr, "trilens: %s%s\n", label, message.c_str());
    }
}

void Console::warn(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (std::find(warnings_.begin(), warnings_.end(), message) != warnings_.end()) return;
    warnings_.push_back(message);
    if (!options_.quiet) write_line("warning: ", "33", message);
}

void Console::error(const std::string& message) {
    const std::lock_guard lock(mutex_);
    write_line("error: ", "31", message);
}

void Console::note(const std::string& message) {
    const std::lock_guard lock(mutex_);
    if (options_.verbose && !options_.quiet) write_line("", "0", message);
}

void Console::note_stage(const std::string& what, const Stopwatch& watch) {
    note(fmt::format("{} ({:.3f} s)", what, watch.seconds()));
}

Progress Console::progress(const std::string& job) {
    stop_at_once(false);
    last_done_ = -1;
    told_done_ = 0;
    stage_.clear();
    stage_from_ = 0, stage_until_ = 1;
    time_left_ = {};
    started_ = last_time_ = std::chrono::steady_clock::now();
    Progress progress;
    progress.cancel = &stop_requested();
    if (options_.progress != ProgressStyle::kSilent)
        progress.report = [this, job](double done) { draw(job, done); };
    progress.stage = [this](const std::string& what, double until) { begin_stage(what, until); };
    return progress;
}

/// Each goes at a speed of its own, of which what was before tells nothing.
void Console::begin_stage(const std::string& what, double until) {
    const std::lock_guard lock(mutex_);
    if (what != stage_) last_done_ = -1;
    stage_ = what;
    // A stage that runs to the job's end is told in shares of the job's time.
    if (until >= 1 && stage_until_ >= 1) return;
    stage_from_ = told_done_, stage_until_ = until;
    time_left_ = {};
}

void Console::draw(const std::string& job, double done) {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    const double elapsed = std::chrono::duration<double>(now - started_).count();
    const double silent = std::chrono::duration<double>(now - last_time_).count();
    told_done_ = done;
    const double length = stage_until_ - stage_from_,
                 of_stage = length > 0 ? (done - stage_from_) / length : 1;
    const std::optional<double> left = time_left_.at(std::clamp(of_stage, 0.0, 1.0), elapsed);
    const bool is_of_stage = !stage_.empty() && stage_until_ < 1;
    const double step = options_.progress == ProgressStyle::kBar ? 0.01 : 0.1;
    const double most_silent = options_.progress == ProgressStyle::kBar    ? 0.5
                               : options_.progress == ProgressStyle::kJson ? 1
                                                                           : std::max(2.0, elapsed / 20);

    // Short jobs finish without a word: a plain or JSON line is worth it after two seconds.
    if (options_.progress != ProgressStyle::kBar && elapsed < 2) return;
    if (done < 1 && done - last_done_ < step && silent < most_silent) return;
    last_done_ = done;
    last_time_ = now;
    const int percent = static_cast<int>(100 * done);
    const std::string seconds =
                          left ? fmt::format(", {:.0f} s left{}", *left, is_of_stage ? " of that" : "") : "",
                      text = stage_.empty() ? job : job + ": " + stage_;
    if (options_.progress == ProgressStyle::kJson) {
        const auto quoted = [](const std::string& words) {
            return Json(words).dump(-1, ' ', false, Json::error_handler_t::replace);
        };
        const std::string stage = stage_.empty() ? "" : "\"stage\":" + quoted(stage_) + ",";
        std::fprintf(stderr, "{\"t\":%.1f,\"job\":%s,%s\"done\":%.3f,\"eta_s\":%s}\n", elapsed,
                     quoted(job).c_str(), stage.c_str(), done,
                     left && !is_of_stage ? fmt::format("{:.1f}", *left).c_str() : "null");
    } else if (options_.progress == ProgressStyle::kPlain) {
        std::fprintf(stderr, "trilens: %s %d %%%s\n", text.c_str(), percent, seconds.c_str());
    } else if (done >= 1) {
        clear_bar();
    } else {
        const int filled = static_cast<int>(30 * done);
        std::fprintf(stderr, "\r\033[K%s [%s%s] %3d %%%s", text.c_str(),
                     std::string(static_cast<std::size_t>(filled), '#').c_str(),
                     std::string(static_cast<std::size_t>(30 - filled), ' ').c_str(), percent,
                     seconds.c_str());
        std::fflush(stderr);
        bar_shown_ = true;
    }
}

namespace fs = std::filesystem;

bool is_standard_stream(const std::string& file) {
    return file == "-";
}

bool is_one_file(const std::string& one, const std::string& other) {
    std::error_code failure;
    if (fs::equivalent(one, other, failure)) return true;
    const fs::path a = fs::weakly_canonical(one, failure), b = fs::weakly_canonical(other, failure);
    return !a.empty() && a == b;
}

void FileRoles::reads(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        if (file.empty() || is_standard_stream(file)) continue;
        // Known as an input first, so that nothing writes there even while it fails.
        inputs_.push_back(file);
        for (const std::string& output : outputs_)
            if (is_one_file(output, file)) throw UsageError("the output " + output + " is the input " + file);
    }
}

void FileRoles::writes(const std::string& file) {
    if (file.empty() || is_standard_stream(file)) return;
    check_writable(file, inputs_);
    for (const std::string& output : outputs_)
        if (is_one_file(output, file))
            throw UsageError("the outputs " + output + " and " + file + " are one file");
    outputs_.push_back(file);
}

bool FileRoles::has_old_outputs() const {
    std::error_code failure;
    return std::ranges::any_of(outputs_,
                               [&](const std::string& output) { return fs::exists(output, failure); });
}

}  // namespace trilens
