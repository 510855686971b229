#include "scene/read/resolved.h"

#include "scene/json/json_check.h"
#include "scene/read/reading.h"

namespace trilens {

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

}  // namespace trilens
