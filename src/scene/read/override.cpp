#include "scene/read/override.h"

#include <charconv>
#include <vector>

#include "base/util/error.h"
#include "base/util/suggestion.h"
#include "scene/json/json_check.h"
#include "scene/read/reading.h"
#include "scene/read/scene_fields.h"

namespace trilens {

// Walks document and schema side by side along a JSON pointer (RFC 6901).

namespace {

struct Target {
    const SceneOverride& change;
    const std::string& file;

    [[noreturn]] void fail(const std::string& message) const {
        fail_at(file, change.pointer, message + " (in --set)");
    }
};

std::vector<std::string> split_pointer(const Target& target) {
    const std::string& pointer = target.change.pointer;
    if (pointer.empty() || pointer[0] != '/')
        target.fail("'" + pointer + "' is no JSON pointer: it must begin with '/'");
    std::vector<std::string> keys;
    for (std::size_t i = 0; i < pointer.size(); ++i) {
        if (pointer[i] == '/') {
            keys.emplace_back();
        } else if (pointer[i] == '~') {
            const char next = i + 1 < pointer.size() ? pointer[i + 1] : ' ';
            if (next != '0' && next != '1') target.fail("'~' in a JSON pointer must be followed by 0 or 1");
            keys.back() += next == '0' ? '~' : '/';
            ++i;
        } else {
            keys.back() += pointer[i];
        }
    }
    return keys;
}

Json parse_value(const Target& target) {
    constexpr bool kIgnoreComments = true;
    const std::string& text = target.change.value;
    if (!Json::accept(text, kIgnoreComments)) return text;
    return parse_json(text, target.file + ": " + target.change.pointer + " (in --set)");
}

/// The part `key` of `value`, which is added to an object whose schema knows it or leaves it free.
Json& step(Json& value, const std::string& key, const Json* schema, const Target& target) {
    if (value.is_array()) {
        std::size_t index = value.size();
        const auto end = key.data() + key.size();
        const auto [stop, error] = std::from_chars(key.data(), end, index);
        const bool leading_zero = key.size() > 1 && key[0] == '0';
        if (error != std::errc() || stop != end || leading_zero || index >= value.size())
            target.fail("no entry '" + key + "': the array has " + std::to_string(value.size()) +
                        (value.size() == 1 ? " entry" : " entries") + ", counted from 0");
        return value[index];
    }
    if (!value.is_object()) target.fail("names nothing: " + describe(value) + " has no part '" + key + "'");
    if (!value.contains(key) && schema && !is_free_key(key) &&
        !schema_of_part(*schema, key, scene_schema_json()))
        target.fail("names nothing: unknown key '" + key + "'" + suggestion(key, known_keys(*schema)));
    return value[key];
}

/// Takes away what the pointer names, which must be there.
void remove(Json& scene, const Target& target) {
    const Json::json_pointer place(target.change.pointer);
    if (!scene.contains(place) || place.empty()) target.fail("names nothing that could be removed");
    Json& parent = scene[place.parent_pointer()];
    if (parent.is_array())
        parent.erase(static_cast<std::size_t>(std::stoul(place.back())));
    else
        parent.erase(place.back());
}

void apply(Json& scene, const Target& target) {
    const Json& root = scene_schema_json();
    const std::vector<std::string> keys = split_pointer(target);
    if (target.change.removes) return remove(scene, target);
    Json* value = &scene;
    const Json* schema = &root;
    for (const std::string& key : keys) {
        value = &step(*value, key, schema, target);
        schema = schema ? schema_of_part(*schema, key, root) : nullptr;
        const bool last = &key == &keys.back();
        if (!value->is_null() || last) continue;
        if (schema && !(schema->contains("type") && schema->at("type") == "object"))
            target.fail("names nothing: there is no '" + key + "' yet");
        *value = Json::object();
    }
    *value = parse_value(target);
}

}  // namespace

void apply_overrides(Json& scene, std::span<const SceneOverride> overrides, const std::string& file) {
    for (const SceneOverride& change : overrides) apply(scene, {change, file});
}

Json resolved_json(const Scene& scene) {
    const std::string title = scene_title(scene);
    Json json = parse_json(scene.resolved, title);
    if (const auto found = find_problem(json, scene_schema_json()))
        throw InputError(title, found->place, found->message);
    const auto count = [&](const char* key) { return json.contains(key) ? json.at(key).size() : 0; };
    if (count("meshes") != scene.meshes.size() || count("cameras") != scene.cameras.size())
        throw InputError(title, "", "its JSON has other meshes or cameras than the scene itself");
    return json;
}

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
