// What `trilens scene info` answers: what a scene holds.
#pragma once

#include <trilens/scene.h>

#include "terminal/command.h"

namespace trilens {

/// The film, counts and a line for each camera and mesh; the fields of `trilens.scene/1`. A camera's facets
/// are named after the general linear cameras of Yu and McMillan (2004). Throws as make_camera does.
Answer info_answer(const Scene& scene);

}  // namespace trilens
