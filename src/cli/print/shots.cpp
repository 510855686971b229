#include "cli/print/shots.h"

#include <trilens/text.h>

#include <iterator>

#include "cli/print/projections.h"
#include "terminal/libraries.h"

namespace trilens {
namespace {

Json shot_json(const Renderer& renderer, std::span<const OpticInfo> optics, const ShotRays& shots,
               const ShotRay& ray) {
    Json fields{{"state", name_of(ray.state)}};
    if (!ray.followed()) return fields;
    fields["origin"] = vector_json(ray.origin);
    fields["direction"] = vector_json(ray.direction);
    fields["weight"] = vector_json(ray.weight);
    fields["cut"] = ray.cut;
    fields["sees"] = nullptr;
    if (ray.state == ShotState::kSeen)
        fields["sees"] = {{"object", ray.object},
                          {"name", renderer.scene().meshes[ray.object].name},
                          {"primitive", ray.primitive},
                          {"t", json_number(ray.t)},
                          {"position", vector_json(ray.position)}};
    fields["events"] = Json::array();
    for (const PathEvent& event : shots.events_of(ray)) fields["events"].push_back(event_json(optics, event));
    return fields;
}

/// The letters of a path's events, P for one that has none in a word.
std::string letters_of(std::span<const PathEvent> events) {
    std::string letters;
    for (const PathEvent& event : events)
        letters += event.event == Event::kReflect ? 'R' : event.event == Event::kTransmit ? 'T' : 'P';
    return letters;
}

void add_vector(std::string& text, const Vec3& v) {
    fmt::format_to(std::back_inserter(text), ",{:.12g},{:.12g},{:.12g}", v.x, v.y, v.z);
}

}  // namespace

Json event_json(std::span<const OpticInfo> optics, const PathEvent& event) {
    return {{"optic", optics[event.optic].name},
            {"event", event_name(event.event)},
            {"front", event.front},
            {"face", event.face},
            {"u", json_number(event.uv.x)},
            {"v", json_number(event.uv.y)},
            {"point", vector_json(event.point)},
            {"normal", vector_json(event.normal)}};
}

std::string event_csv(std::span<const OpticInfo> optics, const PathEvent& event) {
    std::string text = fmt::format("{},{},{:d},{},{:.12g},{:.12g}", csv_text(optics[event.optic].name),
                                   event_name(event.event), event.front, event.face, event.uv.x, event.uv.y);
    add_vector(text, event.point);
    add_vector(text, event.normal);
    return text;
}

Json shots_json(const Renderer& renderer, const ShotRays& shots) {
    const std::vector<OpticInfo> optics = renderer.optics();
    Json list = Json::array();
    for (const ShotRay& ray : shots.rays) list.push_back(shot_json(renderer, optics, shots, ray));
    return list;
}

std::string shots_text(const Renderer& renderer, const ShotRays& shots) {
    std::string text =
        "ray,state,path,object,primitive,x,y,z,t,origin_x,origin_y,origin_z,"
        "direction_x,direction_y,direction_z,weight_r,weight_g,weight_b,cut\n";
    for (std::size_t i = 0; i < shots.rays.size(); ++i) {
        const ShotRay& ray = shots.rays[i];
        text += std::to_string(i) + ',' + name_of(ray.state) + ',' + letters_of(shots.events_of(ray));
        if (ray.state == ShotState::kSeen) {
            text += ',' + csv_text(renderer.scene().meshes[ray.object].name) + ',' +
                    std::to_string(ray.primitive);
            add_vector(text, ray.position);
            fmt::format_to(std::back_inserter(text), ",{:.12g}", ray.t);
        } else {
            text += ",,,,,,";
        }
        if (ray.followed()) {
            for (const Vec3& v : {ray.origin, ray.direction, ray.weight}) add_vector(text, v);
            text += ray.cut ? ",1\n" : ",0\n";
        } else {
            text += ",,,,,,,,,,\n";
        }
    }
    return text;
}

std::string shot_events_text(const Renderer& renderer, const ShotRays& shots) {
    const std::vector<OpticInfo> optics = renderer.optics();
    std::string text = "ray,step,optic,event,front,face,u,v,x,y,z,normal_x,normal_y,normal_z\n";
    for (std::size_t i = 0; i < shots.rays.size(); ++i) {
        std::size_t step = 0;
        for (const PathEvent& event : shots.events_of(shots.rays[i])) {
            text += std::to_string(i) + ',' + std::to_string(step++) + ',' + event_csv(optics, event);
            text += '\n';
        }
    }
    return text;
}

}  // namespace trilens
