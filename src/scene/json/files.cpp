// Reads a file, or says why not.
#include "scene/json/files.h"

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/util/error.h"

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

std::string_view utf8_text(std::string_view bytes, const std::string& file) {
    constexpr std::string_view kUtf8 = "\xEF\xBB\xBF", kLittle = "\xFF\xFE", kBig = "\xFE\xFF";
    constexpr std::string_view kBig32("\0\0\xFE\xFF", 4);
    for (const std::string_view mark : {kLittle, kBig, kBig32})
        if (bytes.substr(0, mark.size()) == mark)
            throw InputError(file, "", "is UTF-16 or UTF-32 text: save it as UTF-8");
    return bytes.substr(0, kUtf8.size()) == kUtf8 ? bytes.substr(kUtf8.size()) : bytes;
}

}  // namespace trilens
