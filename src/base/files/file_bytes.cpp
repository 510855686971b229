#include "base/files/file_bytes.h"

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <system_error>

#include "base/files/new_file.h"
#include "base/util/error.h"

namespace trilens {
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

void replace_file(const std::string& file, std::span<const unsigned char> bytes) {
    NewFile made(file);
    made.write(0, bytes);
    made.commit();
}

std::size_t readable_size(const std::string& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error)) throw InputError(file, "", "is a folder, not a file");
    std::FILE* in = std::fopen(file.c_str(), "rb");
    if (!in) throw InputError(file, "", "cannot be read: " + std::generic_category().message(errno));
    std::fclose(in);
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) throw InputError(file, "", "cannot be read: " + error.message());
    return static_cast<std::size_t>(size);
}

}  // namespace trilens
