// Whole files as bytes: written beside their name and renamed, with the reason where that fails.
#pragma once

#include <span>
#include <string>

namespace trilens {

/// Writes `bytes` to a new file in the same folder, then renames it to `file`: a reader sees the old file or
/// the whole new one. A symbolic link stays, the file that it names is replaced. Leaves nothing behind on
/// failure. Throws OutputError with the system's reason, and for devices and pipes, which renaming would
/// destroy.
void replace_file(const std::string& file, std::span<const unsigned char> bytes);

/// The size of a file that can be read. Throws InputError: missing, a folder, not permitted.
std::size_t readable_size(const std::string& file);

/// A library's report as the one line that an Error's message is; "unknown reason" where it is empty.
std::string one_line(const std::string& report);

}  // namespace trilens
