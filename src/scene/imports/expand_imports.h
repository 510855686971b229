// A scene file's "import": the glTF scenes that it takes in, with what the file itself says laid over them by
// name.
#pragma once

#include "json/json.h"
#include "scene/data/scene_inputs.h"
#include "scene/read/reading.h"

namespace trilens {

/// Whether a file's name ends as a glTF's: .gltf or .glb.
bool is_gltf_name(const std::string& file);

/// Replaces `import` of a scene by what it names. Cameras, materials, meshes and lights of the scene change
/// the imported ones of the same name, key by key (JSON Merge Patch, RFC 7396: null takes a key away), or are
/// added; new cameras come first, so that they are the scene's own. Film, background and render settings are
/// laid over. Without any camera, one is added that shows all of the first glTF; without any light, two. Both
/// are told in warnings. `options` are those of every glTF, over what its entry says.
/// Throws InputError for an `import` that the schema does not allow and for glTF files that cannot be used;
/// UsageError where there are options but nothing to import.
void expand_imports(Json& scene, const ImportOptions& options, Reading& reading);

}  // namespace trilens
