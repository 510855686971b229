#include "base/files/check_output.h"

#include <unistd.h>

#include <filesystem>
#include <system_error>

#include "base/files/file_bytes.h"
#include "base/util/error.h"

namespace trilens {

void check_writable(const std::string& file, const std::vector<std::string>& inputs) {
    const std::filesystem::path path(file);
    const std::filesystem::path folder =
        path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    std::error_code code;
    if (file.empty()) throw OutputError(file, "the output has no name");
    if (!std::filesystem::is_directory(folder, code))
        throw OutputError(file, "there is no folder " + folder.string());
    if (std::filesystem::is_directory(path, code)) throw OutputError(file, "is a folder");
    output_target(file);
    for (const std::string& input : inputs)
        if (std::filesystem::equivalent(path, input, code))
            throw UsageError("the output " + file + " is the input " + input);
    if (access(folder.c_str(), W_OK) != 0)
        throw OutputError(file, "the folder " + folder.string() + " is not writable");
}

}  // namespace trilens
