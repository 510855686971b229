// What `trilens scene info` answers: what a scene holds.
#pragma once

#include <trilens/scene.h>

#include "terminal/command.h"

namespace trilens {

/// The film, cameras, counts and a line for each mesh; the fields of `trilens.scene/1`.
Answer info_answer(const Scene& scene);

}  // namespace trilens
