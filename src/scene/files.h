// Whole files as strings.
#pragma once

#include <string>

namespace trilens {

/// Throws InputError(file) that says why: missing, a directory, not readable.
std::string read_required_file(const std::string& file);

}  // namespace trilens
