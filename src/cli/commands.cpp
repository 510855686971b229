// The whole program: every command that there is.
#include "cli/commands.h"

namespace trilens {
namespace {

void add_examples(Command& command, const std::string& called) {
    command.examples = examples_of(called);
    for (Command& below : command.commands) add_examples(below, called + " " + below.name);
}

}  // namespace

Command make_commands() {
    Command root{.name = "trilens",
                 .summary = "draw what curved mirrors and glass show, by projection, and measure its error"};
    root.commands = render_commands();
    for (Command& command : std::vector<Command>{
             compare_command(), sweep_command(), report_command(), test_command(), project_command(),
             shoot_command(), fit_command(), design_command(), unwrap_command(), map_command(),
             anamorph_command(), scene_command(), info_command()})
        root.commands.push_back(std::move(command));
    add_examples(root, root.name);
    return root;
}

}  // namespace trilens
