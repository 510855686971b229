#include "scene/parameters.h"

#include <algorithm>
#include <charconv>
#include <memory>

#include "base/description/material.h"
#include "base/util/format.h"
#include "json/schema.h"
#include "scene/data/scene_digest.h"
#include "scene/load.h"
#include "scene/read/override.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// What a missing key of a transform means; null for every other key.
Json default_of(const std::string& pointer) {
    const auto ends_with = [&](const char* end) { return pointer.ends_with(end); };
    if (ends_with("/transform/translate")) return {0, 0, 0};
    if (ends_with("/transform/rotate")) return {0, 0, 0, 1};
    if (ends_with("/transform/scale")) return {1, 1, 1};
    return nullptr;
}

std::string text_of(double value) {
    char room[64];
    return {room, std::to_chars(room, room + sizeof room, value).ptr};
}

/// The place that a key names in an array; the array's size where it names none.
std::size_t place_of(const std::string& key, std::size_t size) {
    std::size_t place = size;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), place);
    return error == std::errc() && end == key.data() + key.size() ? place : size;
}

/// The pointer with entries that are named by their "name" replaced by their places.
std::string placed(const Json& root, const std::string& pointer, const std::string& file) {
    std::string done;
    const Json* at = &root;
    for (std::size_t from = 1; from <= pointer.size();) {
        const std::size_t end = std::min(pointer.find('/', from), pointer.size());
        std::string key = pointer.substr(from, end - from);
        if (at && at->is_array()) {
            std::size_t place = at->size();
            for (std::size_t i = 0; i < at->size(); ++i)
                if ((*at)[i].is_object() && (*at)[i].value("name", Json()) == Json(key)) place = i;
            if (place < at->size()) key = std::to_string(place);
        }
        done += '/' + key;
        at = !at                                                        ? nullptr
             : at->is_object() && at->contains(key)                     ? &(*at)[key]
             : at->is_array() && place_of(key, at->size()) < at->size() ? &(*at)[place_of(key, at->size())]
                                                                        : nullptr;
        from = end + 1;
    }
    if (pointer.empty() || pointer[0] != '/')
        fail_at(file, pointer, "is no JSON pointer: it must begin with '/'");
    return done;
}

void add_numbers(const Json& value, const std::string& pointer, const std::string& file,
                 std::vector<SceneNumber>& numbers) {
    if (value.is_number()) {
        numbers.push_back({pointer, value.get<double>()});
        return;
    }
    if (!value.is_array() || value.empty())
        fail_at(file, pointer, "is no number and no array of numbers, but " + describe(value));
    for (std::size_t i = 0; i < value.size(); ++i)
        add_numbers(value[i], pointer + '/' + std::to_string(i), file, numbers);
}

/// The document's part at a pointer; null where it names none.
Json part_at(const Json& root, const std::string& pointer, const std::string& file) {
    try {
        const Json::json_pointer at(pointer);
        return root.contains(at) ? root.at(at) : Json(nullptr);
    } catch (const Json::exception&) {
        fail_at(file, pointer, "is no JSON pointer");
    }
}

Json checked_json(const Scene& scene) {
    if (scene.resolved.empty())
        fail_at(scene_title(scene), "",
                "was built in memory and has no JSON, whose numbers pointers could name");
    return resolved_json(scene);
}

}  // namespace

std::vector<SceneNumber> find_numbers(const Scene& scene, std::span<const std::string> pointers) {
    const Json root = checked_json(scene);
    const std::string file = scene_title(scene);
    std::vector<SceneNumber> numbers;
    for (const std::string& asked : pointers) {
        const std::string pointer = placed(root, asked, file);
        Json value = part_at(root, pointer, file);
        if (value.is_null()) value = default_of(pointer);
        if (value.is_null())
            fail_at(file, asked, "is not in the scene: derivatives are of numbers that it has");
        if (pointer.starts_with("/film/"))
            fail_at(file, asked, "is no number of a camera, a mesh or a material, on which images depend");
        add_numbers(value, pointer, file, numbers);
    }
    return numbers;
}

Scene scene_with(const Scene& scene, const SceneNumber& number) {
    return scene_with(scene, std::span(&number, 1));
}

namespace {

/// Terrains with a tolerance are flat in scenes whose pictures are blank.
std::vector<FilmMove> unseen(std::span<const FilmMoveQuery> queries) {
    return std::vector<FilmMove>(queries.size());
}

/// A text that stands for the scene's own.
Scene read_untextured(const Scene& scene, const std::string& text, std::span<const SceneOverride> changes) {
    const auto blank = std::make_shared<const Texture>();
    const TextureReader no_textures{[&](const std::string&) { return blank; },
                                    [&](std::span<const unsigned char>, const std::string&) { return blank; },
                                    [&](const std::string& file) {
                                        for (const Mesh& mesh : scene.meshes)
                                            if (mesh.terrain && mesh.terrain->file == file)
                                                return *mesh.terrain->heights;
                                        throw InputError(file, "", "is no terrain of the scene before");
                                    },
                                    {},
                                    [](const Scene&) { return unseen; }};
    return load_scene_text(text, SceneSource(scene_title(scene), scene.folder), changes, no_textures);
}

}  // namespace

Scene scene_with(const Scene& scene, std::span<const SceneNumber> numbers) {
    const Json root = checked_json(scene);
    std::vector<SceneOverride> changes;
    std::string begun;
    for (const SceneNumber& number : numbers) {
        const std::string parent = number.pointer.substr(0, number.pointer.rfind('/'));
        if (parent != begun && part_at(root, parent, scene_title(scene)).is_null() &&
            !default_of(parent).is_null())
            changes.push_back({parent, default_of(parent).dump()});
        begun = parent;
        changes.push_back({number.pointer, text_of(number.value)});
    }
    return read_untextured(scene, scene.resolved, changes);
}

bool is_same_scene(const Scene& scene, const std::string& text) {
    return scene_digest(read_untextured(scene, text, {})) ==
           scene_digest(read_untextured(scene, scene.resolved, {}));
}

}  // namespace trilens
