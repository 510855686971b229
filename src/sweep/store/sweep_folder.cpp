#include "sweep/store/sweep_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <filesystem>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/format.h"

namespace trilens {
namespace fs = std::filesystem;
namespace {

constexpr const char* kWhatToDo = "choose another folder, or discard what is there with --replace";

std::string manifest_file(const std::string& folder) {
    return folder + "/manifest.json";
}
std::string plan_file(const std::string& folder) {
    return folder + "/plan.jsonl";
}
/// Held by every process at work in the folder.
std::string users_lock(const std::string& folder) {
    return folder + "/lock";
}

bool can_be_read(const fs::path& file) {
    std::error_code unreadable;
    return fs::exists(file, unreadable);
}

const std::string& scene_name(const SweepSubject& subject) {
    return subject.scene_name.empty() ? subject.scene : subject.scene_name;
}

std::string axis_names(const SweepAxes& axes) {
    std::string names;
    for (const Axis& axis : axes.axes)
        names += (names.empty() ? "" : axes.zip ? " with " : " x ") + axis.kind.name;
    return names.empty() ? "nothing" : names;
}

std::string owner_text(const SweepManifest& manifest) {
    const SweepSubject& subject = manifest.subject;
    return fmt::format("the sweep of {} over {} (camera {}, truth {})", scene_name(subject),
                       axis_names(manifest.axes), subject.camera, subject.truth);
}

/// One of the sweeps in folders below; none where there are none.
std::optional<std::string> sweep_below(const std::string& folder) {
    std::error_code unreadable;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
        if (can_be_read(entry->path() / "manifest.json")) return entry->path().filename().string();
    return std::nullopt;
}

void require_free(const std::string& folder, const SweepManifest& manifest) {
    if (!can_be_read(manifest_file(folder))) {
        if (const std::optional<std::string> below = sweep_below(folder))
            throw UsageError(fmt::format("{} holds a gallery of sweeps ({} is one); choose another folder",
                                         folder, *below));
        require_no_foreign_files(folder);
        return;
    }
    std::optional<SweepManifest> owner;
    try {
        owner = read_manifest(manifest_file(folder));
    } catch (const InputError& error) {
        throw InputError("", "", fmt::format("{}; {}", error.what(), kWhatToDo));
    }
    if (is_same_sweep(*owner, manifest)) return;
    throw UsageError(fmt::format("{} belongs to {}, this is {}; {}", folder, owner_text(*owner),
                                 owner_text(manifest), kWhatToDo));
}

}  // namespace

std::string plan_lock(const std::string& folder) {
    return folder + "/plan.lock";
}

bool is_same_sweep(const SweepManifest& a, const SweepManifest& b) {
    const SweepSubject &one = a.subject, &other = b.subject;
    const bool is_same_scene = scene_name(one) == scene_name(other) ||
                               (!one.scene_digest.empty() && one.scene_digest == other.scene_digest);
    return is_same_scene && one.camera == other.camera && one.truth == other.truth &&
           axis_names(a.axes) == axis_names(b.axes);
}

FileLock claim_folder(const std::string& folder, const SweepManifest& manifest,
                      const std::vector<PlannedRun>& plan, const Progress& progress) {
    make_folder(folder);
    const FileLock planner = FileLock::wait(plan_lock(folder), LockKind::kOne, progress);
    std::optional<FileLock> user = FileLock::try_lock(users_lock(folder), LockKind::kOne);
    const bool is_alone = user.has_value();
    if (!is_alone) user = FileLock::wait(users_lock(folder), LockKind::kMany, progress);
    require_free(folder, manifest);
    // Whoever is at work sums up the plan that lies in the folder at the end.
    if (!is_alone && read_whole_file(plan_file(folder)) != plan_text(plan))
        throw UsageError(folder +
                         " is being swept with other values, or another state of the scene; wait until that "
                         "ends, or choose another folder");
    const bool is_new = !can_be_read(manifest_file(folder));
    make_folder(folder + "/truth");
    make_folder(folder + "/runs");
    replace_text_file(manifest_file(folder), manifest_text(manifest, plan));
    replace_text_file(plan_file(folder), plan_text(plan));
    if (is_new) begin_report_lists(folder);
    user->share();
    return std::move(*user);
}

std::size_t count_other_runs(const std::string& folder, const std::vector<PlannedRun>& plan) {
    std::set<std::string> planned;
    for (const PlannedRun& run : plan) planned.insert(run.id);
    std::size_t others = 0;
    std::error_code unreadable;
    for (fs::directory_iterator entry(folder + "/runs", unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
        others += !planned.contains(entry->path().filename().string()) && can_be_read(entry->path() / "DONE");
    return others;
}

void clear_folder(const std::string& folder) {
    if (!can_be_read(manifest_file(folder))) return;
    const std::optional<FileLock> alone = FileLock::try_lock(users_lock(folder), LockKind::kOne);
    if (!alone) throw UsageError(folder + " cannot be replaced: another process is sweeping into it");
    bool is_sweep = true;
    try {
        read_manifest(manifest_file(folder));
    } catch (const InputError&) {
        is_sweep = false;
    }
    remove_own_files(folder, is_sweep);
}

void require_no_sweep(const std::string& folder) {
    if (can_be_read(manifest_file(folder)))
        throw UsageError(
            folder + " holds a sweep, whose report several scenes would write over; choose another folder");
    if (can_be_read(folder + "/report.html") && !sweep_below(folder))
        throw UsageError(folder +
                         "/report.html is there already and no gallery's: it would be lost; choose " +
                         "another folder");
}

namespace {

constexpr std::chrono::milliseconds kFirstPause(1), kLongestPause(100);

[[noreturn]] void refuse(const std::string& file, int error_number) {
    throw OutputError(file, "cannot be locked: " + std::generic_category().message(error_number));
}

}  // namespace

std::optional<FileLock> FileLock::try_lock(const std::string& file, LockKind kind) {
    const int descriptor = open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor < 0) refuse(file, errno);
    FileLock lock(descriptor);
    const int operation = (kind == LockKind::kOne ? LOCK_EX : LOCK_SH) | LOCK_NB;
    while (flock(descriptor, operation) != 0) {
        if (errno == EWOULDBLOCK) return std::nullopt;
        if (errno != EINTR) refuse(file, errno);
    }
    return lock;
}

FileLock FileLock::wait(const std::string& file, LockKind kind, const Progress& progress) {
    for (auto pause = kFirstPause;; pause = std::min(2 * pause, kLongestPause)) {
        if (std::optional<FileLock> lock = try_lock(file, kind)) return std::move(*lock);
        progress.stop_if_cancelled();
        std::this_thread::sleep_for(pause);
    }
}

void FileLock::share() {
    while (flock(descriptor_, LOCK_SH) != 0)
        if (errno != EINTR) refuse("a lock", errno);
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace trilens
