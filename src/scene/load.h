// Reads a scene file with everything it names into a Scene.
#pragma once

#include <span>
#include <string>
#include <utility>

#include "lens/prescription.h"
#include "scene/data/scene.h"
#include "scene/data/scene_inputs.h"
#include "scene/read/scene_schema.h"

namespace trilens {

/// Reads, checks and resolves a scene file; a glTF is the scene that imports it. `overrides` are applied to
/// the JSON before it is checked; a pointer that names nothing is an error, but missing keys that the schema
/// knows are added, with the objects on the way to the last. Throws InputError with the file and the place
/// (JSON pointer, or line of an OBJ) of the first problem, and UsageError for `import` where nothing is
/// imported. What is legal but doubtful goes to Scene::warnings.
Scene load_scene(const std::string& file, std::span<const SceneOverride> overrides,
                 const TextureReader& textures, const ImportOptions& import = {});

/// The lens of a file, by the ending of its name: Zemax (.zmx), CODE V (.seq), or JSON (.json) with the
/// `surfaces` of an entry of a scene's `lenses`. Glasses of the catalogue `glass_file` (.agf) come before
/// those that are built in. Throws InputError with the file and the place in it.
LensPrescription load_lens(const std::string& file, const std::string& glass_file = "");

/// A side of a lens out of JSON as a scene's primitive has it, Q-type aspheres among them: "radius", "conic",
/// "coefficients", "normalDepartures", "qcon", "qbfs", "normalizationRadius", "aperture". `label` stands in
/// messages. Throws InputError with the key of what is wrong.
LensSide parse_lens_side(const std::string& json, const std::string& label = "side");

/// Where a scene's text comes from.
struct SceneSource {
    SceneSource(std::string named);                               // relative paths start at the file's folder
    SceneSource(std::string named, std::string paths_start_here)  // or somewhere else
        : file(std::move(named)), folder(std::move(paths_start_here)) {}

    std::string file;    // stands in messages; need not exist
    std::string folder;  // may be empty: where the program runs
};

/// The same from text in memory, as an image's header holds it: Scene::files lacks the scene file itself.
Scene load_scene_text(const std::string& text, const SceneSource& source,
                      std::span<const SceneOverride> overrides, const TextureReader& textures,
                      const ImportOptions& import = {});

/// The scene as the text of a scene file that lies in `folder` (absolute): what was imported and overridden
/// is in it, and the files that it names are named from there. Throws InputError for a scene built in memory.
std::string scene_document(const Scene& scene, const std::string& folder);

/// Gives every optic this resolution, or with a name those of that name, in the scene and in its resolved
/// JSON. Throws InputError unless it is in 1..1024, or where Scene::resolved is no scene's JSON, UsageError
/// where no optic has the name; then nothing has changed.
void set_resolution(Scene& scene, int resolution, const std::string& optic = "");

}  // namespace trilens
