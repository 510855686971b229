// The commands of trilens.
#pragma once

#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

std::vector<Command> render_commands();  // render and trace
Command compare_command();
Command sweep_command();
Command sweep_submit_command();
std::vector<Command> sweep_folder_commands();  // status, report, merge, schema
Command report_command();
Command project_command();
Command shoot_command();
Command unwrap_command();
Command map_command();
Command caustic_command();
Command bake_command();
Command anamorph_command();
Command fit_command();
Command design_command();
Command test_command();
Command scene_command();
Command lens_command();
Command info_command();
Command view_command();  // starts the viewer, a program of its own
Command cad_command();   // as well

/// The whole program, each command with its examples.
Command make_commands();

/// The examples of a command by its whole name, "trilens sweep run"; none for names without.
std::vector<Example> examples_of(const std::string& called);

}  // namespace trilens
