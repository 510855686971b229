#include "scene/resolved.h"

#include "scene/json_check.h"
#include "scene/reading.h"

namespace trilens {

Json resolved_json(const Scene& scene) {
    const std::string title = scene_title(scene);
    Json json = parse_json(scene.resolved, title);
    if (const auto found = find_problem(json, scene_schema_json()))
        throw InputError(title, found->place, found->message);
    if (json.at("meshes").size() != scene.meshes.size() || json.at("cameras").size() != scene.cameras.size())
        throw InputError(title, "", "its JSON has other meshes or cameras than the scene itself");
    return json;
}

}  // namespace trilens
