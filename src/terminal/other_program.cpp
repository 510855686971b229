#include "terminal/other_program.h"

#include <trilens/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <sstream>
#include <vector>

namespace trilens {
namespace {

/// As a shell looks for it: execvp() would tell of a folder that may not be searched where no other has the
/// program.
std::optional<std::filesystem::path> find_in_path(const std::string& name) {
    const char* const path = std::getenv("PATH");
    std::istringstream folders(path ? path : "/bin:/usr/bin");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::filesystem::path file = std::filesystem::path(folder.empty() ? "." : folder) / name;
        std::error_code none;
        if (std::filesystem::is_regular_file(file, none) && access(file.c_str(), X_OK) == 0) return file;
    }
    return std::nullopt;
}

}  // namespace

void become_program(const std::string& name, const std::string& missing, const Console& console) {
    std::vector<std::string> words{name};
    words.insert(words.end(), console.words().begin(), console.words().end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::error_code none;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", none);
    if (!none) execv((self.parent_path() / name).c_str(), arguments.data());
    const std::optional<std::filesystem::path> installed = find_in_path(name);
    if (!installed) throw ComputationError(missing);
    execv(installed->c_str(), arguments.data());
    throw ComputationError("the program " + name + " cannot be started: " + std::strerror(errno));
}

}  // namespace trilens
