#include "terminal/file_roles.h"

#include <trilens/error.h>
#include <trilens/files.h>
#include <algorithm>
#include <filesystem>
#include <system_error>

namespace trilens {
namespace fs = std::filesystem;

bool is_standard_stream(const std::string& file) {
    return file == "-";
}

bool is_one_file(const std::string& one, const std::string& other) {
    std::error_code failure;
    if (fs::equivalent(one, other, failure)) return true;
    const fs::path a = fs::weakly_canonical(one, failure), b = fs::weakly_canonical(other, failure);
    return !a.empty() && a == b;
}

void FileRoles::reads(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        if (file.empty() || is_standard_stream(file)) continue;
        // Known as an input first, so that nothing writes there even while it fails.
        inputs_.push_back(file);
        for (const std::string& output : outputs_)
            if (is_one_file(output, file)) throw UsageError("the output " + output + " is the input " + file);
    }
}

void FileRoles::writes(const std::string& file) {
    if (file.empty() || is_standard_stream(file)) return;
    check_writable(file, inputs_);
    for (const std::string& output : outputs_)
        if (is_one_file(output, file))
            throw UsageError("the outputs " + output + " and " + file + " are one file");
    outputs_.push_back(file);
}

bool FileRoles::has_old_outputs() const {
    std::error_code failure;
    return std::ranges::any_of(outputs_,
                               [&](const std::string& output) { return fs::exists(output, failure); });
}

}  // namespace trilens
