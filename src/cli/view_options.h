// What `trilens view` takes: the command, which starts the viewer, and the viewer read the same.
#pragma once

#include <functional>
#include <string>

#include "cli/options.h"
#include "terminal/command.h"

namespace trilens {

struct ViewOptions {
    SceneOptions scene;
    std::string script;          // a file of steps, or "-"; empty: none
    std::string screenshot;      // PNG of the window at the end
    std::string window_size;     // "1280x800"
    std::string display_server;  // HOST:PORT; empty: none
    bool window = false;         // the script runs in a window, too
};

/// The command, with what it does.
Command view_command(std::function<Answer(const ViewOptions&, Console&)> view);

}  // namespace trilens
