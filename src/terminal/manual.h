// Manual pages and shell completion, made from the tree of commands.
#pragma once

#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

/// A page of the manual.
struct ManualPage {
    std::string name;  // "trilens-sweep-run"; its file is NAME.1
    std::string roff;  // for man(1)
};

/// The pages of the whole tree: one for the program and for each command.
std::vector<ManualPage> manual_pages(const Command& root);

/// What completes the program's command line in a shell: commands, options, choices, names of example scenes,
/// files by their endings.
std::string bash_completion(const Command& root);
std::string zsh_completion(const Command& root);
std::string fish_completion(const Command& root);

/// A command of the tree with its whole name, "trilens sweep run".
struct NamedCommand {
    std::string called;
    const Command* command = nullptr;
};

/// The tree, each group before its commands.
std::vector<NamedCommand> all_commands(const Command& root);

/// The words a shell offers for a value, where they are known: choices, examples, shells.
std::vector<std::string> offered_words(const Option& option, const Command& root);

/// Endings of the files that a shell offers, without the dot; none for every file.
std::vector<std::string> offered_endings(Offer offer);

/// Whether a shell offers files or folders.
bool offers_files(Offer offer);

}  // namespace trilens
