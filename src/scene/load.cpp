// From a scene file to a Scene: parse, override, check against the schema, then read part by part.
#include "scene/load.h"

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/files/files.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/names.h"
#include "json/json.h"
#include "json/schema.h"
#include "scene/animation/animation_keys.h"
#include "scene/data/light_objects.h"
#include "scene/formats/lens_file.h"
#include "scene/imports/expand_imports.h"
#include "scene/imports/expand_lenses.h"
#include "scene/imports/housing.h"
#include "scene/read/override.h"
#include "scene/read/read_lens.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

void check_unique(const std::string& name, const Node& node, std::set<std::string>& names) {
    if (names.insert(name).second) return;
    (node.has("name") ? node["name"] : node).fail("the name '" + name + "' is taken already");
}

void read_cameras(const Node& root, Reading& reading) {
    std::set<std::string> names;
    const Node cameras = root["cameras"];
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        reading.scene.cameras.push_back(read_camera(cameras[i], i, reading));
        check_unique(reading.scene.cameras.back().name, cameras[i], names);
    }
}

void read_materials(const Node& root, Reading& reading) {
    std::set<std::string> names;
    if (!root.has("materials")) return;
    const Node materials = root["materials"];
    for (std::size_t i = 0; i < materials.size(); ++i) {
        reading.scene.materials.push_back(read_material(materials[i], reading));
        check_unique(reading.scene.materials.back().name, materials[i], names);
    }
    reading.named_materials = reading.scene.materials.size();
}

void read_meshes(const Node& root, Reading& reading) {
    std::set<std::string> names;
    std::set<Id> used;
    if (root.has("meshes")) {
        const Node meshes = root["meshes"];
        for (std::size_t i = 0; i < meshes.size(); ++i) {
            const Mesh& mesh = reading.scene.meshes.emplace_back(read_mesh(meshes[i], i, reading));
            if (!names.insert(mesh.name).second)
                reading.warn(meshes[i].place, "the name '" + mesh.name + "' is taken already");
            used.insert(mesh.material);
        }
    }
    if (reading.scene.meshes.empty() && !root.has("volumes") && !root.has("points"))
        reading.warn("", "the scene has no meshes");
    for (Id i = 0; i < reading.named_materials; ++i)
        if (used.count(i) == 0)
            reading.warn("/materials/" + std::to_string(i),
                         "the material '" + reading.scene.materials[i].name + "' is not used");
}

/// The terrains that wait for all else.
void read_terrains_as_seen(const Node& root, Reading& reading) {
    if (!root.has("meshes")) return;
    const Node meshes = root["meshes"];
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        if (!meshes[i].has("tolerance")) continue;
        if (!reading.film_moves) {
            TRILENS_CHECK(reading.textures.film_moves, "a scene with a tolerance needs to know what is seen");
            reading.film_moves = reading.textures.film_moves(reading.scene);
        }
        reading.scene.meshes[i] = read_mesh(meshes[i], i, reading);
    }
}

/// What would be seen, but is black or plain.
void warn_of_appearance(Reading& reading) {
    const Scene& scene = reading.scene;
    std::set<Id> of_objects;
    for (const Mesh& mesh : scene.meshes) {
        if (mesh.role != Role::kObject) continue;
        of_objects.insert(mesh.object.material.begin(), mesh.object.material.end());
    }
    bool needs_light = false;
    for (const Id i : of_objects) {
        if (i >= scene.materials.size()) continue;
        const Material& material = scene.materials[i];
        needs_light = needs_light || (!material.unlit && material.emissive_factor == Vec3(0));
    }
    const bool is_baked = std::any_of(scene.meshes.begin(), scene.meshes.end(),
                                      [](const Mesh& mesh) { return !mesh.object.baked.empty(); });
    if (needs_light && scene.lights.empty() && !is_baked)
        reading.warn("/lights",
                     "there is no light: every object whose material is neither unlit nor emissive is black");
}

/// What a file is instead of a scene, by its name; empty where that does not say.
std::string other_kind(const std::string& file) {
    const std::string ending = file_ending(file);
    const auto is_one_of = [&](std::initializer_list<const char*> endings) {
        return std::find(endings.begin(), endings.end(), ending) != endings.end();
    };
    if (is_one_of({".obj"})) return "is a mesh: a scene names it as the 'file' of one of its meshes";
    if (is_one_of({".zmx", ".seq"})) return "is a lens: a scene names it as the 'file' of one of its lenses";
    if (is_one_of({".step", ".stp", ".iges", ".igs"}))
        return "is a CAD file: 'trilens cad' makes a scene of its bodies";
    return "";
}

/// Rethrows what stands at a place that a change names as the mistake of who asks for the change.
void blame_changes(const InputError& error, const std::string& file,
                   std::span<const SceneOverride> overrides) {
    const std::string what = error.what();
    for (const SceneOverride& change : overrides) {
        const std::string place = one_line(file) + ": " + one_line(change.pointer);
        if (change.set_by.empty() || !what.starts_with(place)) continue;
        const char next = what.size() > place.size() ? what[place.size()] : ':';
        if (next != ':' && next != '/') continue;
        throw InputError(change.set_by, "", what.substr(one_line(file).size() + 2) + " (of " + file + ")");
    }
}

Scene read_scene_text(const std::string& text, const SceneSource& source,
                      std::span<const SceneOverride> overrides, const TextureReader& textures,
                      const ImportOptions& import);

}  // namespace

SceneSource::SceneSource(std::string named)
    : file(std::move(named)), folder(std::filesystem::path(file).parent_path().string()) {}

Scene load_scene_text(const std::string& text, const SceneSource& source,
                      std::span<const SceneOverride> overrides, const TextureReader& textures,
                      const ImportOptions& import) {
    try {
        return read_scene_text(text, source, overrides, textures, import);
    } catch (const InputError& error) {
        blame_changes(error, source.file, overrides);
        throw;
    }
}

namespace {

Scene read_scene_text(const std::string& text, const SceneSource& source,
                      std::span<const SceneOverride> overrides, const TextureReader& textures,
                      const ImportOptions& import) {
    const std::string& file = source.file;
    Json json = parse_json(text, file);
    Reading reading(file, source.folder, textures);
    // What is imported, or made of lenses, must be known before its parts can be changed.
    std::vector<SceneOverride> of_import, of_lenses, others;
    for (const SceneOverride& change : overrides)
        (change.pointer.starts_with("/import")   ? of_import
         : change.pointer.starts_with("/lenses") ? of_lenses
                                                 : others)
            .push_back(change);
    apply_overrides(json, of_import, file);
    expand_imports(json, import, reading);
    apply_overrides(json, of_lenses, file);
    expand_lenses(json, reading);
    apply_overrides(json, others, file);
    if (const auto found = find_problem(json, scene_schema_json()))
        fail_at(file, found->place, found->message);

    if (json.contains("animation")) check_animation({json, "", file});

    const Node root{json, "", file};
    reading.scene.file = file;
    reading.scene.folder =
        std::filesystem::absolute(source.folder.empty() ? "." : source.folder).lexically_normal().string();
    reading.scene.resolved = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    reading.scene.film = read_film(root);
    read_cameras(root, reading);
    reading.scene.background = read_background(root, reading);
    read_materials(root, reading);
    read_meshes(root, reading);
    read_volumes(root, reading);
    read_marks(root, reading);
    read_lights(root, reading);
    add_light_objects(reading.scene);
    reading.scene.render = read_render(root);
    read_terrains_as_seen(root, reading);
    warn_of_appearance(reading);
    return std::move(reading.scene);
}

}  // namespace

Scene load_scene(const std::string& file, std::span<const SceneOverride> overrides,
                 const TextureReader& textures, const ImportOptions& import) {
    if (is_gltf_name(file)) {
        const Json text{{"version", 1}, {"import", std::filesystem::path(file).filename().string()}};
        return load_scene_text(text.dump(-1, ' ', false, Json::error_handler_t::replace), SceneSource(file),
                               overrides, textures, import);
    }
    const std::string text = read_required_file(file);
    if (const std::string kind = other_kind(file); !kind.empty()) throw InputError(file, "", kind);
    Scene scene = load_scene_text(
        is_housing_name(file)
            ? scene_of_housing(text, file).dump(-1, ' ', false, Json::error_handler_t::replace)
            : text,
        SceneSource(file), overrides, textures, import);
    scene.files.insert(scene.files.begin(), make_file_read(file, text));
    return scene;
}

LensPrescription load_lens(const std::string& file, const std::string& glass_file) {
    std::vector<Glass> glasses;
    if (!glass_file.empty()) glasses = parse_agf(read_required_file(glass_file), glass_file);
    return parse_lens(read_required_file(file), file, glasses);
}

LensSide parse_lens_side(const std::string& json, const std::string& label) {
    return parse_side(json, label);
}

namespace {

/// Every "file" of the document, named from another folder.
void move_files(Json& part, const std::filesystem::path& from, const std::filesystem::path& to) {
    if (part.is_array())
        for (Json& entry : part) move_files(entry, from, to);
    if (!part.is_object()) return;
    for (auto& [key, value] : part.items()) {
        const bool names =
            (key == "file" || key == "heights" || key == "glasses" || key.ends_with("Texture")) &&
            value.is_string();
        if (names) {
            const std::filesystem::path path = value.get<std::string>();
            if (path.is_relative())
                value = (from / path).lexically_normal().lexically_proximate(to).generic_string();
        } else if (!is_free_key(key)) {
            move_files(value, from, to);
        }
    }
}

}  // namespace

std::string scene_document(const Scene& scene, const std::string& folder) {
    if (scene.resolved.empty())
        throw InputError(scene_title(scene), "", "was built in memory and has no JSON that could be written");
    Json json = resolved_json(scene);
    const std::filesystem::path to = std::filesystem::path(folder).lexically_normal();
    if (to != std::filesystem::path(scene.folder)) move_files(json, scene.folder, to);
    return json_rows(json);
}

void set_resolution(Scene& scene, int resolution, const std::string& optic) {
    if (resolution < 1 || resolution > kMaxResolution)
        throw InputError(scene_title(scene), "/meshes",
                         "a resolution of " + std::to_string(resolution) + " is not in 1.." +
                             std::to_string(kMaxResolution));
    std::vector<std::size_t> meant;
    std::vector<std::string> names;
    for (std::size_t m = 0; m < scene.meshes.size(); ++m) {
        if (scene.meshes[m].role != Role::kOptic) continue;
        names.push_back(scene.meshes[m].name);
        if (optic.empty() || names.back() == optic) meant.push_back(m);
    }
    if (meant.empty() && !optic.empty())
        throw UsageError("there is no optic \"" + optic + "\"" + suggestion(optic, names));
    Json resolved;
    if (!scene.resolved.empty()) resolved = resolved_json(scene);
    for (const std::size_t m : meant) scene.meshes[m].resolution = resolution;
    if (scene.resolved.empty() || scene.meshes.empty()) return;
    for (const std::size_t m : meant) resolved["meshes"][m]["resolution"] = resolution;
    scene.resolved = resolved.dump();
}

}  // namespace trilens
