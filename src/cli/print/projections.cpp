#include "cli/print/print.h"

#include <trilens/utilities.h>
#include <trilens/version.h>
#include <algorithm>
#include <charconv>
#include <future>
#include <iterator>
#include <utility>

#include "terminal/libraries.h"

namespace trilens {

namespace {

std::string optic_name(const Renderer& renderer, const WorldImage& image) {
    return image.optic == kNone ? "" : renderer.scene().meshes[image.object].name;
}

/// The places too, where they are known.
Json image_steps_json(const Renderer& renderer, std::span<const OpticInfo> optics, const WorldImage& image) {
    if (image.events.size() != image.steps.size()) return steps_json(renderer, image.steps);
    Json list = Json::array();
    for (const PathEvent& event : image.events) list.push_back(event_json(optics, event));
    return list;
}

Json image_json(const Renderer& renderer, std::span<const OpticInfo> optics, const WorldImage& image) {
    Json fields = {{"x", json_number(image.pixel.x)},
                   {"y", json_number(image.pixel.y)},
                   {"t", json_number(image.t)},
                   {"optic", image.optic == kNone ? Json(nullptr) : Json(optic_name(renderer, image))},
                   {"facet", id_json(image.facet)},
                   {"inside", image.inside},
                   {"path", path_name(image.path)},
                   {"length", json_number(image.length)},
                   {"visible", image.visible},
                   {"refined", image.refined},
                   {"off", json_number(image.off)},
                   {"weight", vector_json(image.weight)},
                   {"steps", image_steps_json(renderer, optics, image)}};
    if (image.has_derivative)
        fields["derivative"] = {vector_json(image.derivative[0]), vector_json(image.derivative[1])};
    if (!image.by_parameter.empty()) {
        Json x = Json::array(), y = Json::array();
        for (const Vec2& moved : image.by_parameter) {
            x.push_back(json_number(moved.x));
            y.push_back(json_number(moved.y));
        }
        fields["by_parameter"] = {std::move(x), std::move(y)};
    }
    return fields;
}

/// Room for a number, however long: a double before its point has 309 digits at most.
constexpr std::size_t kNumberRoom = 330;

void add_number(std::string& text, double value, std::chars_format format, int digits) {
    char room[kNumberRoom];
    const auto end = std::to_chars(room, room + kNumberRoom, value, format, digits);
    text.append(room, end.ptr);
    text += ',';
}

void add_count(std::string& text, std::size_t value) {
    char room[kNumberRoom];
    text.append(room, std::to_chars(room, room + kNumberRoom, value).ptr);
    text += ',';
}

void add_line(std::string& text, const Renderer& renderer, std::size_t point, const WorldImage& image) {
    add_count(text, point);
    add_number(text, image.pixel.x, std::chars_format::fixed, 9);
    add_number(text, image.pixel.y, std::chars_format::fixed, 9);
    add_number(text, image.t, std::chars_format::general, 12);
    text += path_name(image.path);
    text += ',';
    if (image.optic != kNone) text += csv_text(renderer.scene().meshes[image.object].name);
    text += ',';
    if (image.facet == kNone)
        text += ',';
    else
        add_count(text, image.facet);
    for (const bool flag : {image.inside, image.visible, image.refined}) text += flag ? "1," : "0,";
    add_number(text, image.off, std::chars_format::general, 6);
    for (int k = 0; k < 3; ++k) add_number(text, image.weight[k], std::chars_format::general, 6);
    text.back() = '\n';
}

/// The lines of points `from` .. `to` - 1, whose images are given back.
std::string lines_of(const Renderer& renderer, std::span<PointProjection> images, std::size_t from,
                     std::size_t to) {
    std::size_t lines = 0;
    for (std::size_t p = from; p < to; ++p) lines += images[p].images.size();
    constexpr std::size_t kUsualLine = 80;
    std::string text;
    text.reserve(kUsualLine * lines);
    for (std::size_t p = from; p < to; ++p)
        for (const WorldImage& image : std::exchange(images[p].images, {}))
            add_line(text, renderer, p, image);
    return text;
}

}  // namespace

Json points_json(const Renderer& renderer, std::span<const Vec3> points,
                 std::span<const PointProjection> images) {
    const std::vector<OpticInfo> optics = renderer.optics();
    Json list = Json::array();
    for (std::size_t p = 0; p < points.size(); ++p) {
        Json entry{{"point", {points[p].x, points[p].y, points[p].z}},
                   {"complete", images[p].complete},
                   {"images", Json::array()}};
        for (const WorldImage& image : images[p].images)
            entry["images"].push_back(image_json(renderer, optics, image));
        list.push_back(std::move(entry));
    }
    return list;
}

std::string point_steps_text(const Renderer& renderer, std::span<const PointProjection> images) {
    const std::vector<OpticInfo> optics = renderer.optics();
    std::string text = "point,image,step,optic,event,front,face,u,v,x,y,z,normal_x,normal_y,normal_z\n";
    for (std::size_t p = 0; p < images.size(); ++p)
        for (std::size_t i = 0; i < images[p].images.size(); ++i)
            for (std::size_t s = 0; s < images[p].images[i].events.size(); ++s)
                text += std::to_string(p) + ',' + std::to_string(i) + ',' + std::to_string(s) + ',' +
                        event_csv(optics, images[p].images[i].events[s]) + '\n';
    return text;
}

std::string points_text(const Renderer& renderer, std::vector<PointProjection> images) {
    constexpr std::size_t kPointsWorthAThread = 1000;
    const std::size_t count = std::clamp<std::size_t>(images.size() / kPointsWorthAThread, 1,
                                                      static_cast<std::size_t>(std::max(1, threads())));
    std::vector<std::future<std::string>> pieces;
    for (std::size_t i = 0; i < count; ++i)
        pieces.push_back(
            std::async([&, from = images.size() * i / count, to = images.size() * (i + 1) / count] {
                return lines_of(renderer, images, from, to);
            }));
    std::string text = "point,x,y,t,path,optic,facet,inside,visible,refined,off,weight_r,weight_g,weight_b\n";
    for (std::future<std::string>& piece : pieces) text += piece.get();
    return text;
}

namespace {

Json ray_json(const Ray& ray) {
    return {{"origin", vector_json(ray.origin)}, {"direction", vector_json(ray.direction)}};
}

Json hit_json(const Renderer& renderer, const Hit& hit) {
    if (!hit.seen()) return nullptr;
    const SeenTriangle seen = renderer.seen_triangle(hit);
    return {{"object", seen.object},
            {"name", renderer.scene().meshes[seen.object].name},
            {"primitive", seen.primitive},
            {"t", json_number(hit.t)},
            {"barycentric", {json_number(hit.barycentric.x), json_number(hit.barycentric.y)}},
            {"position", vector_json(seen.position)}};
}

Json kind_json(const std::optional<GeneralLinearKind>& kind) {
    return kind ? Json(general_linear_kind_name(*kind)) : Json(nullptr);
}

Json end_json(const Renderer& renderer, const PixelEnd* end) {
    if (!end) return nullptr;
    return {{"path", steps_json(renderer, end->steps)},
            {"weight", vector_json(end->weight)},
            {"ray", ray_json(end->ray)},
            {"facet_kind", kind_json(end->facet_kind)},
            {"sees", hit_json(renderer, end->hit)},
            {"cut", end->cut}};
}

}  // namespace

Json explanation_json(const Renderer& renderer, const EngineChoice& engine, const PixelExplanation& pixel) {
    Json fields;
    fields["pixel"] = {pixel.x, pixel.y};
    fields["engine"] = engine_name(engine.engine);
    if (pixel.camera_facet != kNone)
        fields["camera"] = {{"facet", pixel.camera_facet}, {"facet_kind", kind_json(pixel.camera_kind)}};
    fields["ray"] = ray_json(pixel.ray);
    fields["depth"] = json_number(pixel.depth);
    fields["sees"] = hit_json(renderer, pixel.hit);
    if (pixel.optic != kNone) {
        const OpticInfo optic = renderer.optics()[pixel.optic];
        fields["optic"] = {{"object", optic.object},
                           {"name", optic.name},
                           {"facet", pixel.facet},
                           {"uv", {json_number(pixel.uv.x), json_number(pixel.uv.y)}},
                           {"cos_incident", json_number(pixel.cos_incident)},
                           {"front", pixel.front}};
        for (const Path path : {Path::kReflect, Path::kRefract})
            fields[path_name(path)] = end_json(renderer, pixel.find(path));
        fields["ends"] = Json::array();
        for (const PixelEnd& end : pixel.ends) fields["ends"].push_back(end_json(renderer, &end));
        fields["method"] = pixel.traced ? "traced" : pixel.level > 0 ? "subdivided" : "projected";
        fields["level"] = pixel.level;
    }
    fields["colour"] = {{"direct", vector_json(pixel.direct)},
                        {"reflect", vector_json(pixel.reflect)},
                        {"refract", vector_json(pixel.refract)}};
    return fields;
}

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
