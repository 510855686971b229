// The command line as data: commands with their options, from which parsing, help, manual pages and
// completion are made; and what a command gives back.
#pragma once

#include <trilens/error.h>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
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

}  // namespace trilens
