// Text files that are either the old ones or the new ones, never half of one.
#include "base/files/files.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/files/file_bytes.h"
#include "base/util/error.h"

namespace trilens {
namespace fs = std::filesystem;

void replace_text_file(const std::string& file, const std::string& text) {
    replace_file(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

std::optional<std::string> read_whole_file(const std::string& file) {
    std::error_code failure;
    if (!fs::is_regular_file(file, failure)) return std::nullopt;
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    // As much as it has now; it may grow or shrink meanwhile.
    const std::uintmax_t size = fs::file_size(file, failure);
    std::string text(failure ? 0 : static_cast<std::size_t>(size) + 1, '\0');
    std::size_t filled = 0;
    while (in) {
        if (filled == text.size()) text.resize(2 * filled + 4096);
        in.read(text.data() + filled, static_cast<std::streamsize>(text.size() - filled));
        filled += static_cast<std::size_t>(in.gcount());
    }
    if (in.bad()) return std::nullopt;
    text.resize(filled);
    return text;
}

void make_folder(const std::string& folder) {
    if (folder.empty()) return;
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
