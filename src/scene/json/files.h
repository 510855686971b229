// Whole files as strings, and the text in them.
#pragma once

#include <string>
#include <string_view>

namespace trilens {

/// Throws InputError(file) that says why: missing, a directory, not readable.
std::string read_required_file(const std::string& file);

/// `bytes` as UTF-8, without the byte order mark that some programs write before it. Throws InputError(file)
/// where the mark is that of UTF-16 or UTF-32. The view points into `bytes`.
std::string_view utf8_text(std::string_view bytes, const std::string& file);

}  // namespace trilens
