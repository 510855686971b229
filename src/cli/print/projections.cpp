#include "cli/print/projections.h"

#include <trilens/text.h>
#include <trilens/version.h>

#include <algorithm>
#include <charconv>
#include <future>
#include <utility>

#include "cli/print/shots.h"

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
            {"sees", hit_json(renderer, end->hit)}};
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

}  // namespace trilens
