#include "answer/projections.h"

#include "answer/values.h"
#include "terminal/format.h"

namespace trilens {
namespace {

std::string optic_name(const Renderer& renderer, const WorldImage& image) {
    return image.optic == kNone ? "" : renderer.scene().meshes[image.object].name;
}

Json image_json(const Renderer& renderer, const WorldImage& image) {
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
                   {"steps", steps_json(renderer, image.steps)}};
    if (image.has_derivative)
        fields["derivative"] = {vector_json(image.derivative[0]), vector_json(image.derivative[1])};
    return fields;
}

std::string text_line(const Renderer& renderer, std::size_t point, const WorldImage& image) {
    return fmt::format("{},{:.9f},{:.9f},{:.12g},{},{},{},{:d},{:d},{:d}\n", point, image.pixel.x,
                       image.pixel.y, image.t, path_name(image.path), optic_name(renderer, image),
                       image.facet == kNone ? "" : std::to_string(image.facet), image.inside, image.visible,
                       image.refined);
}

}  // namespace

Json points_json(const Renderer& renderer, std::span<const Vec3> points,
                 std::span<const PointProjection> images) {
    Json list = Json::array();
    for (std::size_t p = 0; p < points.size(); ++p) {
        Json entry{{"point", {points[p].x, points[p].y, points[p].z}},
                   {"complete", images[p].complete},
                   {"images", Json::array()}};
        for (const WorldImage& image : images[p].images)
            entry["images"].push_back(image_json(renderer, image));
        list.push_back(std::move(entry));
    }
    return list;
}

std::string points_text(const Renderer& renderer, std::span<const PointProjection> images) {
    std::string text = "point,x,y,t,path,optic,facet,inside,visible,refined\n";
    for (std::size_t p = 0; p < images.size(); ++p)
        for (const WorldImage& image : images[p].images) text += text_line(renderer, p, image);
    return text;
}

}  // namespace trilens
