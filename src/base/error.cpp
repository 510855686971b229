#include "base/error.h"

#include <cctype>

namespace trilens {
namespace {

std::string join(const std::string& file, const std::string& place, const std::string& message) {
    std::string line;
    if (!file.empty()) line += file + ": ";
    if (!place.empty()) line += place + ": ";
    return line + message;
}

}  // namespace

Error::Error(ExitCode code, const std::string& file, const std::string& place, const std::string& message)
    : std::runtime_error(join(file, place, message)), code_(code) {}

std::string one_line(std::string text) {
    for (char& letter : text)
        if (std::iscntrl(static_cast<unsigned char>(letter))) letter = ' ';
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

}  // namespace trilens
