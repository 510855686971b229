// Text files, written beside their name and renamed.
#pragma once

#include <string>

namespace trilens {

/// Replaces `file` by `text` in one step. Throws OutputError; then nothing of the file has changed.
void write_text_file(const std::string& file, const std::string& text);

/// Throws OutputError where a file of that name could not be created: its folder is missing or not writable, or the
/// name is a folder. Asked before long work.
void check_writable(const std::string& file);

}  // namespace trilens
