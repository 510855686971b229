// Whole files as bytes: written beside their name and renamed, with the reason where that fails.
#pragma once

#include <span>
#include <string>

namespace trilens {

/// Where writing to `file` ends: behind symbolic links, the file that they name. Throws OutputError for
/// devices and pipes, which a rename would destroy, and for links in a circle.
std::string output_target(const std::string& file);

/// Writes `bytes` to a new file beside output_target(file), then renames it: a reader sees the old file or
/// the whole new one. Leaves nothing behind on failure. Throws OutputError with the system's reason, and as
/// output_target does.
void replace_file(const std::string& file, std::span<const unsigned char> bytes);

/// The size of a file that can be read. Throws InputError: missing, a folder, not permitted.
std::size_t readable_size(const std::string& file);

}  // namespace trilens
