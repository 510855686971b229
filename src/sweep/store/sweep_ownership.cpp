#include "sweep/store/sweep_folder.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <string_view>
#include <system_error>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"

namespace trilens {
namespace fs = std::filesystem;
namespace {

constexpr const char* kManifest = "manifest.json";
constexpr std::array kReportFolders = {"plots", "pictures"};

// What lies in the folder itself, but for the manifest and the locks.
constexpr std::array kFixedNames = {"report.html", "runs.csv",   "displacement.csv", "summary.json",
                                    "summary.tex", "plan.jsonl", "plots.list",       "pictures.list"};
constexpr std::array kRunNames = {"image.exr", "diff.exr", "metrics.json", "error.json", "DONE", "lock"};
constexpr std::array kTruthEnds = {".exr", ".exr.seconds", ".exr.lock"};

bool is_there(const fs::path& file) {
    std::error_code unreadable;
    return fs::exists(fs::symlink_status(file, unreadable));
}

bool is_all_of(std::string_view text, const char* characters) {
    return !text.empty() && text.find_first_not_of(characters) == std::string_view::npos;
}

/// The name without what replace_file adds while it writes, ".PID-COUNTER.part": a killed process leaves it.
std::string_view finished_name(std::string_view name) {
    constexpr std::string_view kPart = ".part";
    if (!name.ends_with(kPart)) return name;
    const std::string_view whole = name.substr(0, name.size() - kPart.size());
    const std::size_t dot = whole.rfind('.');
    if (dot == std::string_view::npos) return name;
    const std::string_view numbers = whole.substr(dot + 1);
    return is_all_of(numbers, "0123456789-") ? whole.substr(0, dot) : name;
}

bool is_run_file(std::string_view name) {
    return std::ranges::find(kRunNames, finished_name(name)) != kRunNames.end();
}

/// A hash as hash_text writes it, with the end of a truth's file.
bool is_truth_file(std::string_view name) {
    name = finished_name(name);
    constexpr std::size_t kDigits = 16;
    return name.size() > kDigits && is_all_of(name.substr(0, kDigits), "0123456789abcdef") &&
           std::ranges::find(kTruthEnds, name.substr(kDigits)) != kTruthEnds.end();
}

/// "n0008-3.png".
bool is_picture_of(std::string_view name, const PlannedRun& run) {
    constexpr std::string_view kEnd = ".png";
    const std::size_t id = run.id.size();
    return name.size() > id + 1 + kEnd.size() && name.starts_with(run.id) && name[id] == '-' &&
           name.ends_with(kEnd) &&
           is_all_of(name.substr(id + 1, name.size() - id - 1 - kEnd.size()), "0123456789");
}

std::vector<fs::path> entries_of(const fs::path& folder) {
    std::error_code unreadable;
    std::vector<fs::path> entries;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
        entries.push_back(entry->path());
    return entries;
}

void remove_if_empty(const fs::path& folder) {
    std::error_code failure;
    if (!fs::is_directory(fs::symlink_status(folder, failure)) || !entries_of(folder).empty()) return;
    fs::remove(folder, failure);
    if (failure) throw OutputError(folder.string(), "cannot be removed: " + failure.message());
}

/// Every run has taken its lock, so that a folder without one is none of a run's.
void remove_run(const fs::path& home) {
    if (!is_there(home / "lock")) return;
    for (const fs::path& file : entries_of(home))
        if (is_run_file(file.filename().string()) && file.filename() != "lock") remove_file(file.string());
    remove_file((home / "lock").string());
    remove_if_empty(home);
}

std::string list_file(const std::string& folder, const std::string& below) {
    return folder + "/" + below + ".list";
}

/// The names in the list: of files in the folder below and nowhere else, whatever the list says.
std::set<std::string> listed(const std::string& folder, const std::string& below) {
    std::set<std::string> names;
    std::istringstream lines(read_whole_file(list_file(folder, below)).value_or(""));
    for (std::string line; std::getline(lines, line);)
        if (!line.empty() && line != "." && line != ".." && line.find('/') == std::string::npos)
            names.insert(line);
    return names;
}

/// The words of the path from the folder to the file; none where the file lies elsewhere.
std::vector<std::string> place_in(const std::string& folder, const std::string& file) {
    std::error_code unreadable;
    const fs::path home = fs::weakly_canonical(folder, unreadable);
    if (unreadable) return {};
    const fs::path path = fs::weakly_canonical(file, unreadable);
    if (unreadable) return {};
    std::vector<std::string> words;
    for (const fs::path& word : path.lexically_relative(home)) words.push_back(word.string());
    if (!words.empty() && (words[0] == ".." || words[0] == ".")) words.clear();
    return words;
}

bool is_written(const std::vector<std::string>& place, const std::vector<PlannedRun>& plan) {
    if (place.size() == 1)
        return place[0] == kManifest || std::ranges::find(kFixedNames, place[0]) != kFixedNames.end();
    if (place.size() == 3)
        return place[0] == "runs" && is_run_file(place[2]) &&
               std::ranges::find(plan, place[1], &PlannedRun::id) != plan.end();
    if (place.size() != 2) return false;
    return (place[0] == "truth" && is_truth_file(place[1])) ||
           (place[0] == "pictures" &&
            std::ranges::any_of(plan, [&](const PlannedRun& run) { return is_picture_of(place[1], run); }));
}

}  // namespace

void require_no_foreign_files(const std::string& folder) {
    std::error_code unreadable;
    for (const char* name : kFixedNames)
        if (is_there(fs::path(folder) / name) && !fs::is_directory(fs::path(folder) / name, unreadable))
            throw UsageError(folder + "/" + name +
                             " is there already and no sweep's: it would be lost; choose another folder");
}

void require_inputs_apart(const std::string& folder, const std::vector<PlannedRun>& plan,
                          std::span<const std::string> inputs) {
    for (const std::string& input : inputs)
        if (is_written(place_in(folder, input), plan))
            throw UsageError("the sweep would write over its input " + input + "; choose another folder");
}

void begin_report_lists(const std::string& folder) {
    for (const char* below : kReportFolders) begin_report_list(folder, below);
}

void begin_report_list(const std::string& folder, const std::string& below) {
    if (!is_there(list_file(folder, below))) replace_text_file(list_file(folder, below), "");
}

void remove_own_files(const std::string& folder, bool is_sweep) {
    const fs::path home(folder);
    for (const fs::path& run : entries_of(home / "runs")) remove_run(run);
    for (const fs::path& truth : entries_of(home / "truth"))
        if (is_truth_file(truth.filename().string())) remove_file(truth.string());
    for (const char* below : kReportFolders) {
        is_sweep = is_sweep || is_there(list_file(folder, below));
        for (const std::string& name : listed(folder, below)) remove_file((home / below / name).string());
    }
    for (const char* below : {"runs", "truth", "plots", "pictures"}) remove_if_empty(home / below);
    // The manifest goes last: until then the folder is known as a sweep's.
    if (is_sweep)
        for (const char* name : kFixedNames) remove_file((home / name).string());
    remove_file((home / kManifest).string());
}

OwnReportFiles::OwnReportFiles(const std::string& folder, const std::string& below)
    : home_(folder + "/" + below),
      list_(list_file(folder, below)),
      has_list_(is_there(list_)),
      earlier_(listed(folder, below)) {}

void OwnReportFiles::write_list() const {
    std::set<std::string> all = earlier_;
    all.insert(now_.begin(), now_.end());
    std::string text;
    for (const std::string& name : all) text += name + "\n";
    replace_text_file(list_, text);
}

void OwnReportFiles::will_write(const std::vector<std::string>& names) {
    make_folder(home_);
    for (const std::string& name : names) {
        const bool is_known = !has_list_ || earlier_.count(name) > 0 || now_.count(name) > 0;
        const std::string file = home_ + "/" + name;
        if (!is_known && is_there(file))
            throw OutputError(file, "is there already and no report's: it would be lost; move it elsewhere");
    }
    now_.insert(names.begin(), names.end());
    write_list();
}

void OwnReportFiles::remove_others() {
    std::size_t removed = 0;
    for (const std::string& name : earlier_) {
        if (now_.count(name) > 0) continue;
        remove_file(home_ + "/" + name);
        ++removed;
    }
    earlier_ = now_;
    write_list();
    if (removed > 0 && now_.empty()) remove_if_empty(home_);
}

}  // namespace trilens
