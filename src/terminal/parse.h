// The words of a command line taken apart: the one door to CLI11.
#pragma once

#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

/// Which command the words mean.
struct Located {
    std::vector<const Command*> path;  // from the whole program to the command
    std::vector<std::string> rest;     // the words without the commands' names
    std::string unknown;               // a word where a command should stand; empty: none

    const Command& command() const { return *path.back(); }
    std::string called() const;  // "trilens sweep run"
};

/// Walks from group to group. Words that belong to options are passed over.
Located locate(const Command& root, const std::vector<std::string>& words);

/// Says which word is no command, with the nearest one that is.
UsageError unknown_command(const Located& located);

/// Sets the targets of the command's options. Where an option is given that is an answer (--help), only its
/// target is set and nothing is complained of. Throws UsageError: one line that names the option and what it
/// takes.
void parse_options(const Located& located);

/// What --help prints.
std::string help_text(const Located& located);

}  // namespace trilens
