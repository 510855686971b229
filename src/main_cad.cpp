// The program `trilens-cad`: scenes of STEP and IGES files, which `trilens cad` starts with its own words.
#include <cstring>
#include <vector>

#include "cad/run_cad.h"

int main(int argc, char** argv) {
    trilens::Command root{.name = "trilens", .summary = "make scenes of STEP and IGES files"};
    root.commands.push_back(trilens::cad_command(trilens::run_cad));
    // Also by itself: trilens-cad FILE.
    std::vector<const char*> words(argv, argv + argc);
    if (argc < 2 || std::strcmp(argv[1], "cad") != 0) words.insert(words.begin() + 1, "cad");
    return trilens::run_program(std::move(root), static_cast<int>(words.size()), words.data());
}
