// `--set /json/pointer=VALUE`: changes a scene's JSON before it is checked.
#pragma once

#include <span>
#include <string>

#include "scene/data/scene_override.h"
#include "scene/json/json.h"

namespace trilens {

/// Applies the overrides in order. A key that is missing but known to the scene schema is added, with the
/// objects on the way to it. Throws InputError(file, pointer) where a pointer is malformed or names nothing.
void apply_overrides(Json& scene, std::span<const SceneOverride> overrides, const std::string& file);

}  // namespace trilens
