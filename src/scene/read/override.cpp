#include "scene/read/override.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <vector>

#include "base/util/error.h"
#include "base/util/names.h"
#include "json/schema.h"
#include "scene/read/reading.h"

namespace trilens {

// Walks document and schema side by side along a JSON pointer (RFC 6901).

namespace {

struct Target {
    const SceneOverride& change;
    const std::string& file;

    [[noreturn]] void fail(const std::string& message) const {
        fail_at(file, change.pointer, message + (change.set_by.empty() ? " (in --set)" : ""));
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

/// The names of an array's entries; "" for those without.
std::vector<std::string> entry_names(const Json& array) {
    std::vector<std::string> names;
    for (const Json& entry : array) {
        const bool has_name = entry.is_object() && entry.contains("name") && entry.at("name").is_string();
        names.push_back(has_name ? entry.at("name").get<std::string>() : "");
    }
    return names;
}

/// Which entry of an array a key is: by its place, counted from 0, or by its name.
std::size_t entry_of(const Json& array, const std::string& key, const Target& target) {
    std::size_t index = array.size();
    const auto end = key.data() + key.size();
    const auto [stop, error] = std::from_chars(key.data(), end, index);
    const bool leading_zero = key.size() > 1 && key[0] == '0';
    if (error == std::errc() && stop == end && !leading_zero && index < array.size()) return index;
    std::vector<std::string> names = entry_names(array);
    const auto found = std::find(names.begin(), names.end(), key);
    if (found != names.end() && !key.empty()) return static_cast<std::size_t>(found - names.begin());
    std::erase(names, "");
    target.fail("no entry '" + key + "': the array has " + std::to_string(array.size()) +
                (array.size() == 1 ? " entry" : " entries") + ", counted from 0" +
                (names.empty() || key.empty() || !std::isalpha(static_cast<unsigned char>(key[0]))
                     ? ""
                     : suggestion(key, names)));
}

/// The part `key` of `value`, which is added to an object whose schema knows it or leaves it free.
Json& step(Json& value, const std::string& key, const Json* schema, const Target& target) {
    if (value.is_array()) return value[entry_of(value, key, target)];
    if (!value.is_object()) target.fail("names nothing: " + describe(value) + " has no part '" + key + "'");
    if (!value.contains(key) && schema && !is_free_key(key) &&
        !schema_of_part(*schema, key, scene_schema_json()))
        target.fail("names nothing: unknown key '" + key + "'" + suggestion(key, known_keys(*schema)));
    return value[key];
}

/// Takes away what the pointer names, which must be there.
void remove(Json& scene, const std::vector<std::string>& keys, const Target& target) {
    Json* parent = &scene;
    for (std::size_t k = 0; k < keys.size(); ++k) {
        const bool is_last = k + 1 == keys.size();
        if (parent->is_array()) {
            const std::size_t entry = entry_of(*parent, keys[k], target);
            if (is_last) return void(parent->erase(entry));
            parent = &(*parent)[entry];
        } else {
            if (!parent->is_object() || !parent->contains(keys[k]))
                target.fail("names nothing that could be removed");
            if (is_last) return void(parent->erase(keys[k]));
            parent = &(*parent)[keys[k]];
        }
    }
    target.fail("names nothing that could be removed");
}

void apply(Json& scene, const Target& target) {
    const Json& root = scene_schema_json();
    const std::vector<std::string> keys = split_pointer(target);
    if (target.change.removes) return remove(scene, keys, target);
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

std::string pointer_by_places(const Json& scene, const std::string& pointer, const std::string& file) {
    const SceneOverride change{pointer, ""};
    const Target target{change, file};
    std::string places;
    const Json* value = &scene;
    for (std::string& key : split_pointer(target)) {
        if (value && value->is_array()) {
            const std::size_t entry = entry_of(*value, key, target);
            key = std::to_string(entry);
            value = &(*value)[entry];
        } else {
            const bool is_there = value && value->is_object() && value->contains(key);
            value = is_there ? &value->at(key) : nullptr;
        }
        places += "/" + escape_key(key);
    }
    return places;
}

Json resolved_json(const Scene& scene) {
    const std::string title = scene_title(scene);
    Json json = parse_json(scene.resolved, title);
    if (const auto found = find_problem(json, scene_schema_json()))
        throw InputError(title, found->place, found->message);
    const auto count = [&](const char* key) { return json.contains(key) ? json.at(key).size() : 0; };
    // Objects of lights stand after the file's own; lights of a caller's may have none.
    const std::size_t shown =
        static_cast<std::size_t>(std::count_if(scene.lights.begin(), scene.lights.end(), is_visible));
    const bool meshes_fit =
        scene.meshes.size() == count("meshes") || scene.meshes.size() == count("meshes") + shown;
    if (!meshes_fit || count("cameras") != scene.cameras.size())
        throw InputError(title, "", "its JSON has other meshes or cameras than the scene itself");
    return json;
}

}  // namespace trilens
