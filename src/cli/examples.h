// The examples of every command, for help and manual pages.
#pragma once

#include <string>
#include <vector>

namespace trilens {

struct Example {
    const char* line;
    const char* what;
};

/// Those of a command by its whole name, "trilens sweep run"; none for names without.
std::vector<Example> examples_of(const std::string& called);

}  // namespace trilens
