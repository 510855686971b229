// Cameras of a glTF, and KHR_lights_punctual; its extras as JSON.
#include <cmath>

#include <tiny_gltf.h>

#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

constexpr double kQuarterTurn = 1.57079632679489661923;

std::string name_or(const std::string& name, const char* kind, std::size_t index) {
    return name.empty() ? kind + std::to_string(index) : name;
}

GltfCamera read_gltf_camera(const GltfSource& source, std::size_t index) {
    const tinygltf::Camera& in = source.model.cameras[index];
    const std::string place = "/cameras/" + std::to_string(index);
    GltfCamera camera;
    camera.name = in.name;
    camera.perspective = in.type == "perspective";
    const auto within = [&](double value, double most, const char* key) {
        if (!(value > 0 && value <= most)) source.fail(place + "/" + key, "is not above 0, or far too large");
        return value;
    };
    if (camera.perspective) {
        camera.yfov = within(in.perspective.yfov, 2 * kQuarterTurn, "perspective/yfov");
        if (in.perspective.aspectRatio != 0)
            camera.aspect = within(in.perspective.aspectRatio, kLargestCoordinate, "perspective/aspectRatio");
    } else if (in.type == "orthographic") {
        camera.ymag = within(std::fabs(in.orthographic.ymag), kLargestCoordinate, "orthographic/ymag");
        camera.aspect =
            within(std::fabs(in.orthographic.xmag), kLargestCoordinate, "orthographic/xmag") / camera.ymag;
    } else {
        source.fail(place + "/type", "is neither perspective nor orthographic");
    }
    return camera;
}

GltfLight read_gltf_light(GltfSource& source, std::size_t index) {
    const tinygltf::Light& in = source.model.lights[index];
    const std::string place = "/extensions/KHR_lights_punctual/lights/" + std::to_string(index);
    GltfLight light;
    light.name = name_or(in.name, "light", index);
    light.type = in.type;
    if (in.type != "directional" && in.type != "point" && in.type != "spot")
        source.fail(place + "/type", "is neither directional, point nor spot");
    const auto within = [&](double value, double most, const char* key) {
        if (!(value >= 0 && value <= most)) source.fail(place + "/" + key, "is negative, or far too large");
        return value;
    };
    if (!in.color.empty() && in.color.size() != 3) source.fail(place + "/color", "must have 3 numbers");
    for (std::size_t k = 0; k < in.color.size(); ++k)
        light.color[static_cast<int>(k)] = within(in.color[k], kLargestCoordinate, "color");
    light.intensity = within(in.intensity, kLargestCoordinate, "intensity");
    light.range = std::isfinite(in.range) ? within(in.range, kLargestCoordinate, "range") : 0;
    light.inner_cone = within(in.spot.innerConeAngle, kQuarterTurn, "spot/innerConeAngle");
    light.outer_cone = within(in.spot.outerConeAngle, kQuarterTurn + 1e-6, "spot/outerConeAngle");
    if (in.type == "spot" && !(light.inner_cone < light.outer_cone))
        source.fail(place + "/spot", "innerConeAngle must be less than outerConeAngle");
    return light;
}

}  // namespace

Json json_of_gltf(const tinygltf::Value& value) {
    if (value.IsBool()) return value.Get<bool>();
    if (value.IsInt()) return value.Get<int>();
    if (value.IsNumber()) return value.GetNumberAsDouble();
    if (value.IsString()) return value.Get<std::string>();
    if (value.IsArray()) {
        Json list = Json::array();
        for (std::size_t i = 0; i < value.ArrayLen(); ++i)
            list.push_back(json_of_gltf(value.Get(static_cast<int>(i))));
        return list;
    }
    if (value.IsObject()) {
        Json object = Json::object();
        for (const std::string& key : value.Keys()) object[key] = json_of_gltf(value.Get(key));
        return object;
    }
    return nullptr;
}

double gltf_number(const GltfSource& source, const Json& number, double low, double high,
                   const std::string& place) {
    const double value = number.is_number() ? number.get<double>() : NAN;
    if (!(value >= low && value <= high))
        source.fail(place, describe(number) + " is no number in " + describe(low) + ".." + describe(high));
    return value;
}

void read_gltf_views(GltfSource& source, GltfModel& into) {
    for (std::size_t i = 0; i < source.model.cameras.size(); ++i)
        into.cameras.push_back(read_gltf_camera(source, i));
    for (std::size_t i = 0; i < source.model.lights.size(); ++i)
        into.lights.push_back(read_gltf_light(source, i));
}

}  // namespace trilens
