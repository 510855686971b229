#include "view/light_changes.h"

namespace trilens {
namespace {

/// What a fast reading of the scene (scene_at_frame) may change.
bool is_light_part(const std::string& key) {
    return key == "cameras" || key == "film" || key == "lights" || key == "render";
}

}  // namespace

std::optional<std::vector<SceneOverride>> light_changes(const Json& from, const Json& to) {
    std::vector<SceneOverride> changes;
    for (const Json* both : {&from, &to})
        for (const auto& [key, value] : both->items()) {
            const bool same = from.contains(key) && to.contains(key) && from.at(key) == to.at(key);
            if (!same && !is_light_part(key)) return std::nullopt;
            if (same || both == &from) {
                if (!same && !to.contains(key)) changes.push_back({"/" + key, "", true});
                continue;
            }
            if (key != "cameras" || !from.contains(key) || from.at(key).size() != value.size()) {
                if (key == "cameras") return std::nullopt;
                changes.push_back({"/" + key, value.dump(), false});
                continue;
            }
            for (std::size_t i = 0; i < value.size(); ++i)
                if (value[i] != from.at(key)[i])
                    changes.push_back({"/cameras/" + std::to_string(i), value[i].dump(), false});
        }
    return changes;
}

}  // namespace trilens
