#include "terminal/other_program.h"

#include <trilens/error.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

namespace trilens {

void become_program(const std::string& name, const std::string& missing, const Console& console) {
    std::vector<std::string> words{name};
    words.insert(words.end(), console.words().begin(), console.words().end());
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    std::error_code none;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", none);
    if (!none) execv((self.parent_path() / name).c_str(), arguments.data());
    execvp(name.c_str(), arguments.data());
    if (errno == ENOENT) throw ComputationError(missing);
    throw ComputationError("the program " + name + " cannot be started: " + std::strerror(errno));
}

}  // namespace trilens
