// The JSON that a scene keeps of itself.
#pragma once

#include "scene/data/scene.h"
#include "scene/json/json.h"

namespace trilens {

/// Scene::resolved, which is not empty, as a document. Callers may have written it: throws InputError where
/// it is no scene's, as the schema has it, or names other meshes or cameras than the scene has.
Json resolved_json(const Scene& scene);

}  // namespace trilens
