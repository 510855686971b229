// Scenes as callers name them: a file, a picture that carries its scene, or text; with the pictures that they
// name.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/util/error.h"
#include "scene/data/scene.h"
#include "scene/data/scene_inputs.h"

namespace trilens {

/// Which scene, and what is changed in it.
struct SceneRequest {
    std::string file;  // a scene file (JSON), a glTF (.gltf, .glb), or an image (.exr) that carries its scene
    std::vector<SceneOverride> overrides;  // in order, before the scene is checked
    int resolution = 0;                    // 1..1024: of every optic; 0: as the scene says
    ImportOptions import = {};             // of a glTF, or those that the scene imports
    Progress progress = {};  // of what may take minutes (terrains with a tolerance); others report nothing
};

/// Reads, checks and resolves a scene with all that it names. An image's scene has the image's camera as its
/// own; its files are looked for where the scene's were, or beside the image where that folder is gone. What
/// is legal but doubtful is in Scene::warnings. Throws InputError with the file and the place of the first
/// problem, UsageError for `import` where nothing is imported, Interrupted once `progress` says so.
Scene load_scene(const SceneRequest& request);

/// The same from JSON text; `folder`: where relative paths start, empty for where the program runs. `label`:
/// what messages call the scene,
/// empty for "scene".
Scene parse_scene(const std::string& json, const std::string& folder = "",
                  std::span<const SceneOverride> overrides = {}, const std::string& label = "",
                  const ImportOptions& import = {});

/// The camera of that name; the scene's own where the name is empty. Throws UsageError with the nearest name.
std::size_t find_camera(const Scene& scene, const std::string& name);

/// The scene as it is at a frame: see load_frame.
Scene scene_at_frame(const Scene& scene, double frame, std::span<const SceneOverride> changes = {});

/// The same with the camera on a turntable of `frames` frames, which turns it from where the frame has it:
/// see turntable.
Scene scene_on_turntable(const Scene& scene, double frame, std::size_t camera, int frames);

}  // namespace trilens
