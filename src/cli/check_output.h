// Whether a file could be written, asked before long work.
#pragma once

#include <string>

namespace trilens {

/// Throws OutputError where a file of that name could not be created: its folder is missing or not writable,
/// or the name is a folder.
void check_writable(const std::string& file);

}  // namespace trilens
