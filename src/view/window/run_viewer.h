// The viewer's two ways to run: in a window until it is closed, and by a script with or without a window.
#pragma once

#include <string>

#include "cli/view_options.h"
#include "terminal/command.h"

namespace trilens {

/// Views a scene as the options say. Throws InputError for a scene or script that is none, ComputationError
/// where a window is wanted and there is none, OutputError.
Answer run_viewer(const ViewOptions& options, Console& console);

}  // namespace trilens
