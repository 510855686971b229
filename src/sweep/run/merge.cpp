#include "sweep/run/farm_scripts.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"
#include "sweep/store/sweep_folder.h"

namespace trilens {
namespace {

struct Part {
    std::string folder;
    SweepManifest manifest;
    std::vector<PlannedRun> plan;
};

Part read_part(const std::string& folder) {
    Part part{folder, read_manifest(folder + "/manifest.json"), {}};
    part.plan = read_plan(folder + "/plan.jsonl", part.manifest.axes);
    return part;
}

/// The values of both, in the order in which they first occur.
void join_axes(SweepAxes& all, const SweepAxes& more) {
    for (std::size_t i = 0; i < all.axes.size(); ++i)
        for (const AxisValue& value : more.axes[i].values)
            if (std::find(all.axes[i].values.begin(), all.axes[i].values.end(), value) ==
                all.axes[i].values.end())
                all.axes[i].values.push_back(value);
}

/// The plan of all, and the axes in `manifest`.
std::vector<PlannedRun> join_plans(const std::vector<Part>& parts, SweepManifest& manifest) {
    std::vector<PlannedRun> plan;
    std::map<std::string, std::pair<std::string, std::string>> known;  // id -> hash, part
    for (const Part& part : parts) {
        if (!is_same_sweep(parts[0].manifest, part.manifest))
            throw InputError(
                part.folder, "",
                "holds another sweep than " + parts[0].folder + "; only parts of one are merged");
        join_axes(manifest.axes, part.manifest.axes);
        for (const PlannedRun& run : part.plan) {
            const auto [found, is_new] = known.emplace(run.id, std::pair(run.hash, part.folder));
            if (is_new)
                plan.push_back(run);
            else if (found->second.first != run.hash)
                throw InputError(
                    part.folder, "",
                    fmt::format("its run {} is of another scene or another build than that of {}", run.id,
                                found->second.second));
        }
    }
    return plan;
}

void copy_file(const std::string& from, const std::string& to) {
    const std::optional<std::string> bytes = read_whole_file(from);
    if (!bytes) throw InputError(from, "", "cannot be read");
    replace_text_file(to, *bytes);
}

void copy_truth(const std::string& from, const std::string& to) {
    for (const char* end : {"", ".seconds"})
        if (read_whole_file(from + end) && !std::filesystem::exists(to + end))
            copy_file(from + end, to + end);
}

/// DONE last, as everywhere.
void copy_run(const Part& part, const PlannedRun& run, const std::string& folder) {
    const std::string from = run_folder(part.folder, run.id), to = run_folder(folder, run.id);
    clear_run(folder, run);
    for (const char* name : {"image.exr", "diff.exr", "metrics.json", "DONE"})
        copy_file(from + "/" + name, to + "/" + name);
    copy_truth(truth_file(part.folder, run.truth), truth_file(folder, run.truth));
}

/// The run as the parts know it best: finished in one, else failed in one; none where no part has it.
const Part* best_part(const std::vector<Part>& parts, const PlannedRun& run, RunState& state) {
    const Part* best = nullptr;
    state = RunState::kMissing;
    for (const Part& part : parts) {
        const RunState here = load_run(part.folder, run).state;
        if (here == RunState::kDone || (here == RunState::kFailed && !best)) best = &part, state = here;
        if (here == RunState::kDone) break;
    }
    return best;
}

}  // namespace

std::size_t merge_folders(const std::vector<std::string>& folders, const std::string& folder,
                          const Progress& progress) {
    if (folders.empty()) throw UsageError("there is no folder to merge");
    std::vector<Part> parts;
    for (const std::string& one : folders) parts.push_back(read_part(one));
    std::error_code none;
    if (std::filesystem::exists(folder + "/manifest.json", none)) parts.push_back(read_part(folder));
    SweepManifest manifest = parts[0].manifest;
    const std::vector<PlannedRun> plan = join_plans(parts, manifest);

    const FileLock user = claim_folder(folder, manifest, plan, progress);
    std::size_t copied = 0, done = 0;
    for (const PlannedRun& run : plan) {
        progress.stop_if_cancelled();
        RunState state = RunState::kMissing;
        const FileLock lock = FileLock::wait(run_lock(folder, run), LockKind::kOne, progress);
        const Part* const best =
            load_run(folder, run).state == RunState::kDone ? nullptr : best_part(parts, run, state);
        const bool is_elsewhere = best && !std::filesystem::equivalent(best->folder, folder, none);
        if (is_elsewhere && state == RunState::kDone) copy_run(*best, run, folder);
        if (is_elsewhere && state == RunState::kFailed)
            copy_file(run_folder(best->folder, run.id) + "/error.json",
                      run_folder(folder, run.id) + "/error.json");
        copied += is_elsewhere;
        progress(static_cast<double>(++done) / static_cast<double>(plan.size()));
    }
    return copied;
}

}  // namespace trilens
