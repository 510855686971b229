// Text files that are either the old ones or the new ones, never half of one.
#pragma once

#include <optional>
#include <string>

namespace trilens {

/// Makes `text` the content of `file` in one step. Throws OutputError.
void replace_text_file(const std::string& file, const std::string& text);

/// The bytes of `file`; none where it cannot be read.
std::optional<std::string> read_whole_file(const std::string& file);

/// Makes `folder` and what it lies in; the empty name is the current folder, which is there. Throws
/// OutputError.
void make_folder(const std::string& folder);

/// Removes `file` where it exists. Throws OutputError.
void remove_file(const std::string& file);

}  // namespace trilens
