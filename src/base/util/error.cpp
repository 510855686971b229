#include "base/util/error.h"

#include <cctype>
#include <utility>

namespace trilens {
namespace {

/// A line break in a file's name would make two lines of it, and a zero byte would end the text.
std::string without_controls(std::string text) {
    for (char& letter : text)
        if (std::iscntrl(static_cast<unsigned char>(letter))) letter = ' ';
    return text;
}

std::string join(const std::string& file, const std::string& place, const std::string& message) {
    std::string line;
    if (!file.empty()) line += file + ": ";
    if (!place.empty()) line += place + ": ";
    return without_controls(line + message);
}

}  // namespace

Error::Error(ExitCode code, const std::string& file, const std::string& place, const std::string& message)
    : std::runtime_error(join(file, place, message)), code_(code) {}

std::string one_line(std::string text) {
    text = without_controls(std::move(text));
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

}  // namespace trilens
