// The files of one run: what makes it finished, and what it then says.
#include "sweep/store/run_files.h"

#include <sys/stat.h>

#include <array>
#include <cstddef>
#include <optional>

#include "base/files/file_bytes.h"
#include "base/util/error.h"
#include "base/util/hash.h"
#include "base/util/progress.h"
#include "image/image_io.h"
#include "sweep/store/results_json.h"

namespace trilens {
namespace {

constexpr std::array<const char*, 3> kFiles = {"image.exr", "diff.exr", "metrics.json"};

std::optional<std::string> file_hash(const std::string& file) {
    const std::optional<std::string> bytes = read_whole_file(file);
    if (!bytes) return std::nullopt;
    return hash_text(*bytes);
}

/// The text of DONE: the run's hash, then each file with its own, of which that of the picture may be known;
/// none where a file is missing.
std::optional<std::string> done_text(const std::string& folder, const PlannedRun& plan,
                                     const std::string& image_hash = "") {
    std::string text = plan.hash + "\n";
    for (const char* name : kFiles) {
        const bool is_known = name == kFiles.front() && !image_hash.empty();
        const std::optional<std::string> hash =
            is_known ? image_hash : file_hash(run_folder(folder, plan.id) + "/" + name);
        if (!hash) return std::nullopt;
        text += *hash + " " + name + "\n";
    }
    return text;
}

/// The hash of the first of kFiles, on the second line of DONE.
std::string image_hash_in(const std::string& done) {
    const std::size_t line = done.find('\n') + 1;
    return done.substr(line, done.find(' ', line) - line);
}

}  // namespace

std::string run_lock(const std::string& folder, const PlannedRun& plan) {
    make_folder(run_folder(folder, plan.id));
    return run_folder(folder, plan.id) + "/lock";
}

std::string failure_stamp(const std::string& folder, const PlannedRun& plan) {
    // The clock may jump, so that time alone does not tell two files apart.
    struct stat status {};
    if (stat((run_folder(folder, plan.id) + "/error.json").c_str(), &status) != 0) return "";
    return std::to_string(status.st_mtim.tv_sec) + "." + std::to_string(status.st_mtim.tv_nsec) + " " +
           std::to_string(status.st_ino);
}

RunRecord load_run(const std::string& folder, const PlannedRun& plan) {
    const std::string home = run_folder(folder, plan.id);
    RunRecord missing;
    missing.plan = plan;
    // The failure first: who finishes the run meanwhile writes DONE, and only then removes the failure.
    const std::optional<RunRecord> failed =
        parse_run(read_whole_file(home + "/error.json").value_or(""), plan);
    const std::optional<std::string> done = read_whole_file(home + "/DONE");
    if (done && done == done_text(folder, plan)) {
        std::optional<RunRecord> run = parse_run(read_whole_file(home + "/metrics.json").value_or(""), plan);
        if (!run || run->state != RunState::kDone) return missing;
        run->image_hash = image_hash_in(*done);
        return *run;
    }
    return failed && failed->state == RunState::kFailed ? *failed : missing;
}

void clear_run(const std::string& folder, const PlannedRun& plan) {
    const std::string home = run_folder(folder, plan.id);
    make_folder(home);
    remove_file(home + "/DONE");
}

double store_image(const std::string& folder, const PlannedRun& plan, const Image& image) {
    const Stopwatch watch;
    write_exr(run_folder(folder, plan.id) + "/" + kFiles.front(), image);
    return watch.seconds();
}

std::string hash_of_image(const std::string& folder, const PlannedRun& plan) {
    const std::string file = run_folder(folder, plan.id) + "/" + kFiles.front();
    const std::optional<std::string> hash = file_hash(file);
    if (!hash) throw OutputError(file, "what was written cannot be read back");
    return *hash;
}

void store_run(const std::string& folder, const RunRecord& run, const Image& diff) {
    const std::string home = run_folder(folder, run.plan.id);
    write_exr(home + "/diff.exr", diff);
    replace_text_file(home + "/metrics.json", run_text(run));
    const std::optional<std::string> done = done_text(folder, run.plan, run.image_hash);
    if (!done) throw OutputError(home, "what was written cannot be read back");
    replace_text_file(home + "/DONE", *done);
    remove_file(home + "/error.json");
}

void store_failure(const std::string& folder, const RunRecord& run) {
    replace_text_file(run_folder(folder, run.plan.id) + "/error.json", run_text(run));
}

}  // namespace trilens
