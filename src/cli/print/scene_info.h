// What `trilens scene info` answers, what a scene holds; and `trilens info`, the build, its libraries and the
// machine.
#pragma once

#include <trilens/scene.h>

#include "terminal/command.h"

namespace trilens {

// What `trilens scene info` answers: what a scene holds.

/// The film, counts and a line for each camera and mesh; the fields of `trilens.scene/1`. A camera's facets
/// are named after the general linear cameras of Yu and McMillan (2004). Throws as make_camera does.
Answer info_answer(const Scene& scene);

// What `trilens info` answers: the build, its libraries and the machine.

/// The fields of `trilens.info/1`, and a line for each.
Answer build_answer();

}  // namespace trilens
