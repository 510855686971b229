// Whether a file could be written, asked before long work.
#pragma once

#include <string>
#include <vector>

namespace trilens {

/// Throws OutputError where a file of that name could not be created: its folder is missing or not writable,
/// or the name is a folder, a device or a pipe; UsageError where it is one of the files that are read.
void check_writable(const std::string& file, const std::vector<std::string>& inputs);

}  // namespace trilens
