// A glTF as a scene file: the JSON that stands for its nodes, materials, cameras, lights and animation.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "json/json.h"
#include "scene/data/scene_inputs.h"
#include "scene/formats/gltf.h"

namespace trilens {

/// What scenes know of what a glTF may say.
struct KnownKeys {
    std::set<std::string> material, texture, light;
    std::set<std::string> light_types;
};

struct GltfSceneParams {
    std::string file;     // for messages
    std::string written;  // as the scene names it: relative to the scene's folder
    ImportOptions options;
    KnownKeys known;
};

/// `scene`: film (of the first camera's shape, where it has one), cameras, materials that are used, meshes
/// (one per node and material), lights, animation; what a glTF lacks of these is lacking. Its files are named
/// relative to where `written` is. `warnings` are without the file's name.
struct GltfScene {
    Json scene;
    std::vector<std::string> warnings;
};

/// Throws InputError(file, place in the glTF) where a picture is missing or extras.trilens says what is no
/// mesh's, and UsageError where `options` names an animation that there is not.
GltfScene scene_of_gltf(const GltfModel& model, const GltfSceneParams& params);

/// A camera that shows all of it from ahead and somewhat above, its front being +Z, and two lights, as JSON
/// arrays `cameras` and `lights`: for files that have none.
struct GltfStudio {
    Json cameras, lights;
};
GltfStudio studio_of_gltf(const GltfModel& model, const std::string& file);

}  // namespace trilens
