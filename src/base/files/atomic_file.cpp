#include "base/files/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/files/file_bytes.h"
#include "base/util/error.h"

namespace trilens {
namespace {

std::string reason(int error_number) {
    return std::generic_category().message(error_number);
}

}  // namespace

NewFile::NewFile(const std::string& file) : target_(output_target(file)) {
    static std::atomic<unsigned> counter{0};
    constexpr int kMostTries = 1000;
    // Ids of processes come back, so that a name may be one that a killed process left: then the next one is
    // tried.
    int failed = EEXIST;
    for (int tries = 0; tries < kMostTries && failed == EEXIST; ++tries) {
        name_ = target_ + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".part";
        descriptor_ = open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        failed = descriptor_ < 0 ? errno : 0;
    }
    if (failed) fail(reason(failed));
}

NewFile::~NewFile() {
    if (descriptor_ >= 0) close(descriptor_);
    if (name_.empty()) return;
    std::error_code nothing_more_to_do;
    std::filesystem::remove(name_, nothing_more_to_do);
}

void NewFile::fail(const std::string& why) const {
    throw OutputError(target_, "cannot be written: " + why);
}

void NewFile::write(std::uint64_t at, std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(at));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail(reason(written < 0 ? errno : EIO));
        at += static_cast<std::uint64_t>(written);
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
}

void NewFile::commit() {
    // A full disk may speak only here.
    const int failed = close(descriptor_) != 0 ? errno : 0;
    descriptor_ = -1;
    if (failed) fail(reason(failed));
    std::error_code error;
    std::filesystem::rename(name_, target_, error);
    if (error) fail(error.message());
    name_.clear();
}

}  // namespace trilens
