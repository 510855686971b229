// Text files that are either the old ones or the new ones, never half of one.
#include "sweep/files.h"

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/error.h"

namespace trilens {
namespace fs = std::filesystem;

void write_text_file(const std::string& file, const std::string& text) {
    // The process and a count make the name unique, so that shards may write into one folder.
    static std::atomic<unsigned> count{0};
    const std::string beside = file + ".tmp" + std::to_string(getpid()) + "." + std::to_string(count++);
    std::error_code ignored;
    {
        std::ofstream out(beside, std::ios::binary | std::ios::trunc);
        out.write(text.data(), static_cast<std::streamsize>(text.size()));
        out.close();
        if (!out) {
            fs::remove(beside, ignored);
            throw OutputError(file, "cannot be written");
        }
    }
    std::error_code failure;
    fs::rename(beside, file, failure);
    if (failure) {
        fs::remove(beside, ignored);
        throw OutputError(file, "cannot be put in place: " + failure.message());
    }
}

std::optional<std::string> read_text_file(const std::string& file) {
    std::error_code failure;
    if (!fs::is_regular_file(file, failure)) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    if (!in) return std::nullopt;
    return text;
}

void make_folder(const std::string& folder) {
    std::error_code failure;
    fs::create_directories(folder, failure);
    if (failure) throw OutputError(folder, "cannot be made: " + failure.message());
    if (!fs::is_directory(folder, failure)) throw OutputError(folder, "is not a folder");
}

void remove_file(const std::string& file) {
    std::error_code failure;
    fs::remove(file, failure);
    if (failure) throw OutputError(file, "cannot be removed: " + failure.message());
}

}  // namespace trilens
