#include "scene/read/set_resolution.h"

#include "base/util/error.h"
#include "scene/read/resolved.h"

namespace trilens {

void set_resolution(Scene& scene, int resolution) {
    if (resolution < 1 || resolution > kMaxResolution)
        throw InputError(scene_title(scene), "/meshes",
                         "a resolution of " + std::to_string(resolution) + " is not in 1.." +
                             std::to_string(kMaxResolution));
    Json resolved;
    if (!scene.resolved.empty()) resolved = resolved_json(scene);
    for (Mesh& mesh : scene.meshes)
        if (mesh.role == Role::kOptic) mesh.resolution = resolution;
    if (scene.resolved.empty() || scene.meshes.empty()) return;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m)
        if (scene.meshes[m].role == Role::kOptic) resolved["meshes"][m]["resolution"] = resolution;
    scene.resolved = resolved.dump();
}

}  // namespace trilens
