// Overrides: changes of a scene's JSON before it is checked, and the JSON that a scene keeps of itself.
#pragma once

#include <span>
#include <string>

#include "json/json.h"
#include "scene/data/scene.h"
#include "scene/data/scene_inputs.h"

namespace trilens {

/// Applies the overrides in order. An entry of an array is named by its place, counted from 0, or by its own
/// "name": /meshes/2/resolution, /meshes/ball/resolution. A key that is missing but known to the scene schema
/// is added, with the objects on the way to it. Throws InputError(file, pointer) where a pointer is malformed
/// or names nothing.
void apply_overrides(Json& scene, std::span<const SceneOverride> overrides, const std::string& file);

/// The pointer with entries of arrays by their places, where it names them by name; keys that there are not
/// yet stay as they are. Throws as apply_overrides.
std::string pointer_by_places(const Json& scene, const std::string& pointer, const std::string& file);

/// Scene::resolved, which is not empty, as a document. Callers may have written it: throws InputError where
/// it is no scene's, as the schema has it, or names other meshes or cameras than the scene has.
Json resolved_json(const Scene& scene);

}  // namespace trilens
