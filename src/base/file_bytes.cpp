#include "base/file_bytes.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

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

/// Zero, or the errno of the first step that failed. fclose is a step: a full disk may speak only there.
int write_all(std::FILE* out, std::span<const unsigned char> bytes) {
    int failed = 0;
    if (std::fwrite(bytes.data(), 1, bytes.size(), out) != bytes.size()) failed = errno ? errno : EIO;
    if (std::fclose(out) != 0 && !failed) failed = errno;
    return failed;
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

void replace_file(const std::string& named, std::span<const unsigned char> bytes) {
    const std::string file = output_target(named);
    const NewFile temporary = make_temporary(file);
    if (!temporary.stream) throw OutputError(file, "cannot be written: " + reason(temporary.failed));
    const int write_error = write_all(temporary.stream, bytes);
    std::error_code rename_error;
    if (!write_error) {
        std::filesystem::rename(temporary.name, file, rename_error);
        if (!rename_error) return;
    }

    std::error_code nothing_more_to_do;
    std::filesystem::remove(temporary.name, nothing_more_to_do);
    throw OutputError(file,
                      "cannot be written: " + (write_error ? reason(write_error) : rename_error.message()));
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
