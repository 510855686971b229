// The command line as data: commands with their options, from which parsing, help, manual pages and
// completion are made; and what a command gives back.
#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <trilens/error.h>
#include <variant>
#include <vector>

#include "terminal/console.h"
#include "terminal/libraries.h"

namespace trilens {

/// A command's answer. stdout gets `text`, or one JSON object made of the common fields and `fields`.
struct Answer {
    std::string text;
    Json fields = Json::object();
    std::vector<std::string> errors = {};  // for the JSON's `errors`: of jobs that could not run
    ExitCode code = ExitCode::kDone;
    bool is_report = false;  // the text says what was done, and the files and the exit code say it too:
                             // --quiet leaves it out
};

using CommandBody = std::function<Answer(Console&)>;

/// The numbers an option takes, both ends included.
struct Range {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
};

/// Where an option's value goes. A bool makes a flag, a list takes any number of values.
using OptionTarget =
    std::variant<bool*, int*, long long*, std::size_t*, double*, std::string*, std::vector<std::string>*>;

/// What a shell offers for a value.
enum class Offer { kNothing, kScene, kImage, kFile, kFolder, kExample, kCommand };

/// An option, or an argument.
struct Option {
    std::string names;  // "-o,--output"; an argument's has no dash: "SCENE"
    OptionTarget target;
    std::string help;
    std::string value = "";  // what help calls the value: "WxH"; empty for arguments, choices and numbers
    std::vector<std::string> choices = {};  // nothing else is taken
    Range range = {};
    Offer offer = Offer::kNothing;
    bool is_required = false;
    std::string excludes = "";  // the long name of an option that must not be given beside it
    bool is_common = false;     // every command has it
    bool is_answer = false;     // --help and --version: nothing else counts
    std::function<void(const std::vector<std::string>&)> check =
        {};                      // throws UsageError for values it refuses
    bool value_follows = false;  // its value stands behind "=" or is left out: --json
};

/// A line of a command's help and manual page: what one would type, and what for.
struct Example {
    std::string line;
    std::string what;
};

/// A command, or a group of commands.
struct Command {
    std::string name;
    std::string summary;  // one line
    std::vector<Option> options = {};
    std::vector<Command> commands = {};  // of a group
    std::string schema = "";             // the JSON's schema field is "trilens.<schema>/1"; empty for groups
    CommandBody body = {};
    std::vector<Example> examples = {};
};

/// `help`, `man` and `completion` of the whole tree `root`, which must outlive them.
std::vector<Command> manual_commands(const Command& root);

/// Runs the program of these commands: adds the options that every command has and manual_commands, parses,
/// runs one command, prints, and returns the exit code. Never throws: here failures become exit codes.
int run_program(Command root, int argc, const char* const* argv);

// What an option is called and takes, in words: shared by messages, help, manual pages and completion.

/// "-o" and "--output" of "-o,--output".
std::vector<std::string> option_names(const Option& option);

/// The longest name, dashes included.
std::string long_name(const Option& option);

/// "-o/--output": as messages call it.
std::string spoken_name(const Option& option);

bool is_argument(const Option& option);
bool is_flag(const Option& option);
bool takes_many(const Option& option);

/// What stands for the value in a synopsis: "WxH", "N", "exact|classic".
std::string value_name(const Option& option);

/// What the option takes, as a sentence goes on: "an integer from 1 to 1024"; "exact, classic or auto".
std::string takes(const Option& option);

/// The option of that name; null where there is none.
const Option* find_option(const Command& command, const std::string& name);

/// Sets the target. Throws UsageError, in our words, for values that it does not take.
void set_option(const Option& option, const std::vector<std::string>& values);

/// Options one behind the other.
std::vector<Option> joined(std::vector<std::vector<Option>> parts);

/// Integers separated by `separator`. Throws UsageError naming `option` unless there are exactly `count`.
std::vector<int> parse_integers(const std::string& text, char separator, std::size_t count,
                                const std::string& option);

/// "a, b or c".
std::string one_of(const std::vector<std::string>& words);

// The words of a command line taken apart: the one door to CLI11.

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

// Manual pages and shell completion, made from the tree of commands.

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
