// The program `trilens-view`: the viewer, which `trilens view` starts with its own words.
#include <malloc.h>

#include <cstring>
#include <vector>

#include "cli/view_options.h"
#include "view/window/run_viewer.h"

namespace {

/// Pictures follow one another: the memory of one is kept for the next, where giving it back and asking for
/// it anew took a sixth of the time.
void keep_freed_memory() {
#ifdef __GLIBC__
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
    mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the most that it may be
#endif
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    trilens::Command root{.name = "trilens", .summary = "see what curved mirrors and glass show"};
    root.commands.push_back(trilens::view_command(trilens::run_viewer));
    // Also by itself: trilens-view SCENE.
    std::vector<const char*> words(argv, argv + argc);
    if (argc < 2 || std::strcmp(argv[1], "view") != 0) words.insert(words.begin() + 1, "view");
    return trilens::run_program(std::move(root), static_cast<int>(words.size()), words.data());
}
