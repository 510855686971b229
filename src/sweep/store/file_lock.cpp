#include "sweep/store/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "base/util/error.h"

namespace trilens {
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
        if (progress.cancelled()) throw Interrupted();
        std::this_thread::sleep_for(pause);
    }
}

FileLock::~FileLock() {
    if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace trilens
