// Bodies of a CAD file as a scene: optics as NURBS patches, objects as triangles, on a chequered floor.
#pragma once

#include <string>
#include <vector>

#include "cad/cad_file.h"
#include "cli/cad_options.h"

namespace trilens {

struct CadScene {
    std::string text;  // JSON
    std::vector<std::string> warnings;
    std::size_t mirrors = 0, glass = 0, objects = 0, patches = 0;
};

/// z is up, as in the files. Names are made different. Warns of faces that an optic shows more of than they
/// have. Throws InputError with the file's name where a pattern fits no body, a body is to be mirror and
/// glass, or an optic's face has a fault, or a degree that no patch has.
CadScene scene_of_cad(const CadModel& model, const CadOptions& options);

}  // namespace trilens
