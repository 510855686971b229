// Runs the built `trilens` as a user would and keeps what it said.
#pragma once

#include <string>

namespace trilens_test {

struct CommandRun {
    int exit_code = -1;
    std::string out, err;
};

/// `arguments` as one shell line behind the program's name.
CommandRun run_trilens(const std::string& arguments);

/// What a file holds; empty where it cannot be read.
std::string bytes_of(const std::string& file);

/// Writes a file and returns its path.
std::string write_file(const std::string& folder, const std::string& name, const std::string& text);

/// A small legal scene: a mirror sphere in front of a coloured wall, 32 x 24.
std::string small_scene();

/// `text` with the first `what` replaced; it must occur.
std::string replaced(std::string text, const std::string& what, const std::string& by);

}  // namespace trilens_test
