// Locks between processes that share a sweep's folder.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "base/util/progress.h"

namespace trilens {

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

}  // namespace trilens
