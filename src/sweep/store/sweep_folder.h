// Whose a sweep's folder is: one sweep's, and as many processes of it as there are, by locks.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/util/progress.h"
#include "sweep/store/results.h"

namespace trilens {

// Locks between processes that share a sweep's folder.

/// kOne: one holder alone. kMany: any number of holders, but none of kOne.
enum class LockKind { kOne, kMany };

/// A lock on a file, held until it is destroyed. The system frees it when the process ends, however it ends;
/// the empty file stays and means nothing. Two holders in one process exclude each other as two processes do.
class FileLock {
  public:
    /// None while another holder is in the way. Makes the file. Throws OutputError where it cannot be made or
    /// the file system has no locks.
    static std::optional<FileLock> try_lock(const std::string& file, LockKind kind);

    /// Waits for the other holders to end. Throws Interrupted once `progress` says so, and as try_lock does.
    static FileLock wait(const std::string& file, LockKind kind, const Progress& progress);

    ~FileLock();
    FileLock(FileLock&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
    FileLock& operator=(FileLock&& other) noexcept {
        std::swap(descriptor_, other.descriptor_);
        return *this;
    }

  private:
    explicit FileLock(int descriptor) : descriptor_(descriptor) {}
    int descriptor_;
};

/// Whether two manifests tell of one sweep, so that their results may lie in one folder: the same axis,
/// camera and truth, of the same scene by its name or by what it holds. The values along the axis are free.
bool is_same_sweep(const SweepManifest& a, const SweepManifest& b);

/// Makes the folder the sweep's and writes its manifest and plan. The lock keeps the folder the sweep's until
/// it is destroyed; other processes of the same sweep share it. Throws UsageError where it holds another
/// sweep or a gallery of sweeps, or files of a sweep's names that are none's, InputError where it holds a
/// manifest that cannot be read, OutputError.
FileLock claim_folder(const std::string& folder, const SweepManifest& manifest,
                      const std::vector<PlannedRun>& plan, const Progress& progress);

/// Removes all that sweeps write from a sweep's folder, and nothing else, as remove_own_files does; does
/// nothing to other folders. Throws UsageError while a process is at work in it, OutputError.
void clear_folder(const std::string& folder);

/// The file whose lock a process holds while it reads and writes the manifest, or writes the report.
std::string plan_lock(const std::string& folder);

/// Throws UsageError where a gallery would write over a report: the folder is a sweep's own, or holds one
/// and no sweeps below it.
void require_no_sweep(const std::string& folder);

}  // namespace trilens
