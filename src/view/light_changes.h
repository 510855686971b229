// What differs between two scenes, where a fast reading suffices.
#pragma once

#include <trilens/scene.h>

#include <optional>
#include <vector>

#include "terminal/libraries.h"

namespace trilens {

/// The changes of cameras, film, lights and settings that make `to` of `from`; none where more differs.
std::optional<std::vector<SceneOverride>> light_changes(const Json& from, const Json& to);

}  // namespace trilens
