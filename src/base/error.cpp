#include "base/error.h"

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

}  // namespace trilens
