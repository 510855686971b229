#include "cli/print/values.h"

namespace trilens {

Json vector_json(const Vec3& v) {
    return {json_number(v.x), json_number(v.y), json_number(v.z)};
}

Json optional_json(const std::optional<double>& value) {
    return value ? json_number(*value) : Json(nullptr);
}

Json id_json(Id id) {
    return id == kNone ? Json(nullptr) : Json(id);
}

Json steps_json(const Renderer& renderer, std::span<const Step> steps) {
    Json list = Json::array();
    for (const Step& step : steps)
        list.push_back({{"optic", renderer.optics()[step.optic].name}, {"event", event_name(step.event)}});
    return list;
}

}  // namespace trilens
