// The program `trilens-view`: the viewer, which `trilens view` starts with its own words.
#include <cstring>
#include <vector>

#include "cli/view_options.h"
#include "view/window/run_viewer.h"

int main(int argc, char** argv) {
    trilens::Command root{.name = "trilens", .summary = "see what curved mirrors and glass show"};
    root.commands.push_back(trilens::view_command(trilens::run_viewer));
    // Also by itself: trilens-view SCENE.
    std::vector<const char*> words(argv, argv + argc);
    if (argc < 2 || std::strcmp(argv[1], "view") != 0) words.insert(words.begin() + 1, "view");
    return trilens::run_program(std::move(root), static_cast<int>(words.size()), words.data());
}
