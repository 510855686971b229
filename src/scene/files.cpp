// Reads a file, or says why not.
#include "scene/files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/error.h"

namespace trilens {

std::string read_required_file(const std::string& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw InputError(file, "", "is a directory, not a file");
    if (std::filesystem::is_character_file(file, ignored) || std::filesystem::is_block_file(file, ignored))
        throw InputError(file, "", "is a device, not a file");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file, "", std::string("cannot be opened: ") + std::strerror(errno));
    std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
    if (stream.bad()) throw InputError(file, "", "cannot be read");
    return text;
}

}  // namespace trilens
