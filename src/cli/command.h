// What a command is to the program: options in, one answer out.
#pragma once

#include <trilens/error.h>
#include <functional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/json.h"

namespace CLI {
class App;
}

namespace trilens {

/// A command's answer. stdout gets `text`, or one JSON object made of the common fields and `fields`.
struct Answer {
    std::string text;
    Json fields = Json::object();
    std::vector<std::string> errors;  // for the JSON's `errors`: of jobs that could not run
    ExitCode code = ExitCode::kDone;
};

using CommandBody = std::function<Answer(Console&)>;

/// Where commands register: each adds its sub-command with its options to `app` and calls `on_chosen` with
/// its body. `name` is what the JSON schema field says: "trilens.<name>/1".
struct CommandRegistry {
    CLI::App* app = nullptr;
    std::function<void(CLI::App* command, const std::string& name, CommandBody body)> add;
};

void register_render(const CommandRegistry& registry);  // render and trace
void register_compare(const CommandRegistry& registry);
void register_sweep(const CommandRegistry& registry);
void register_sweep_engines(const CommandRegistry& registry, CLI::App& sweep);
void register_project(const CommandRegistry& registry);
void register_scene(const CommandRegistry& registry);
void register_info(const CommandRegistry& registry);

/// The whole program: parses, runs one command, prints, and returns the exit code. Never throws.
int run_command_line(int argc, const char* const* argv);

}  // namespace trilens
