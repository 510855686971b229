#include "base/file_bytes.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/error.h"

namespace trilens {
namespace {

std::string reason(int error_number) {
    return std::generic_category().message(error_number);
}

struct NewFile {
    std::string name;
    std::FILE* stream = nullptr;  // null where none could be made
    int failed = 0;               // errno then
};

/// A new file beside `file`. Ids of processes come back, so that a name may be one that a killed process
/// left: then the next one is tried.
NewFile make_temporary(const std::string& file) {
    static std::atomic<unsigned> counter{0};
    constexpr int kMostTries = 1000;
    NewFile made;
    for (int tries = 0; tries < kMostTries && !made.stream; ++tries) {
        made.name = file + "." + std::to_string(getpid()) + "-" + std::to_string(counter++) + ".part";
        made.stream = std::fopen(made.name.c_str(), "wbx");
        made.failed = made.stream ? 0 : errno;
        if (made.failed != 0 && made.failed != EEXIST) break;
    }
    return made;
}

}  // namespace

std::string output_target(const std::string& file) {
    namespace fs = std::filesystem;
    constexpr int kMostLinks = 40;  // as the system has it; a longer chain is a circle
    fs::path target = file;
    std::error_code error;
    for (int links = 0; fs::is_symlink(target, error); ++links) {
        if (links == kMostLinks) throw OutputError(file, "cannot be written: its links form a circle");
        const fs::path next = fs::read_symlink(target, error);
        if (error) throw OutputError(file, "cannot be written: " + error.message());
        target = target.parent_path() / next;
    }
    const fs::file_status status = fs::status(target, error);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status))
        throw OutputError(file, "is a device or a pipe, not a file");
    return target.string();
}

FileReplacement::FileReplacement(const std::string& file) : file_(output_target(file)) {
    NewFile made = make_temporary(file_);
    if (!made.stream) fail(reason(made.failed));
    temporary_ = std::move(made.name);
    stream_ = made.stream;
}

FileReplacement::~FileReplacement() {
    if (stream_) std::fclose(stream_);
    std::error_code nothing_more_to_do;
    if (!is_committed_) std::filesystem::remove(temporary_, nothing_more_to_do);
}

void FileReplacement::fail(const std::string& reason) const {
    throw OutputError(file_, "cannot be written: " + reason);
}

void FileReplacement::write(std::span<const unsigned char> bytes, std::size_t offset) {
    errno = 0;
    if (offset != at_ && fseeko(stream_, static_cast<off_t>(offset), SEEK_SET) != 0) fail(reason(errno));
    if (std::fwrite(bytes.data(), 1, bytes.size(), stream_) != bytes.size())
        fail(reason(errno ? errno : EIO));
    at_ = offset + bytes.size();
}

void FileReplacement::commit() {
    // fclose is a step: a full disk may speak only there.
    const int closed = std::fclose(std::exchange(stream_, nullptr)) != 0 ? errno : 0;
    if (closed) fail(reason(closed));
    std::error_code error;
    std::filesystem::rename(temporary_, file_, error);
    if (error) fail(error.message());
    is_committed_ = true;
}

void replace_file(const std::string& file, std::span<const unsigned char> bytes) {
    FileReplacement replacement(file);
    replacement.write(bytes, 0);
    replacement.commit();
}

std::size_t readable_size(const std::string& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw InputError(file, "", "is a folder, not a file");
    std::FILE* in = std::fopen(file.c_str(), "rb");
    if (!in) throw InputError(file, "", "cannot be read: " + reason(errno));
    std::fclose(in);
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) throw InputError(file, "", "cannot be read: " + error.message());
    return static_cast<std::size_t>(size);
}

}  // namespace trilens
