// What `trilens cad` takes: the command, which starts the program trilens-cad, and that program read the
// same.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "terminal/command.h"

namespace trilens {

struct CadOptions {
    std::string file, output;
    std::vector<std::string> mirrors, glass;  // patterns of bodies' names; both empty: all are mirrors
    double ior = 1.5;
    double deviation = 1e-3;  // of objects' triangles, as a share of the file's size
};

/// The command, with what it does.
Command cad_command(std::function<Answer(const CadOptions&, Console&)> convert);

}  // namespace trilens
