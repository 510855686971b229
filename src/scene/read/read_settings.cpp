// Film, background, lights, materials and render settings out of checked JSON.
#include <algorithm>
#include <cmath>
#include <system_error>

#include "base/util/check.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180;
}  // namespace

std::shared_ptr<const Texture> read_picture(Reading& reading, const std::string& path) {
    std::shared_ptr<const Texture>& texture = reading.texture_of_path[path];
    if (texture) return texture;
    TRILENS_CHECK(reading.textures.from_file, "a scene with pictures needs a texture reader");
    return texture = reading.textures.from_file(path);
}

std::shared_ptr<const Texture> read_picture(Reading& reading, const Node& path) {
    const std::string resolved = reading.resolve(path.json.get<std::string>());
    std::error_code ignored;
    if (!std::filesystem::exists(resolved, ignored))
        path.fail("the picture '" + resolved + "' does not exist");
    try {
        return read_picture(reading, resolved);
    } catch (const InputError& error) {
        path.fail(error.what());
    }
}

Vec3 read_direction(const Node& direction) {
    const Vec3 unit = normalize_or_zero(to_vec3(direction.json));
    if (unit == Vec3(0)) direction.fail("a direction must not be zero");
    return unit;
}

Film read_film(const Node& scene) {
    Film film;
    if (!scene.has("film")) return film;
    const Node node = scene["film"];
    film.width = int_or(node, "width", film.width);
    film.height = int_or(node, "height", film.height);
    film.spp = int_or(node, "spp", film.spp);
    const std::string filter = string_or(node, "filter", "box");
    film.filter = filter == "mitchell"   ? FilterKind::kMitchell
                  : filter == "gaussian" ? FilterKind::kGaussian
                                         : FilterKind::kBox;
    if (static_cast<long long>(film.width) * film.height > kMostPixels)
        node.fail(std::to_string(film.width) + " x " + std::to_string(film.height) +
                  " pixels are more than " + std::to_string(kMostPixels));
    return film;
}

Background read_background(const Node& scene, Reading& reading) {
    Background background;
    if (!scene.has("background")) return background;
    const Node node = scene["background"];
    background.color = vec3_or(node, "color", background.color);
    if (node.has("file")) background.environment = read_picture(reading, node["file"]);
    const double angle = std::remainder(number_or(node, "rotate", 0), 360) * kRadiansPerDegree;
    background.rotate_cos = std::cos(angle);
    background.rotate_sin = std::sin(angle);
    return background;
}

Light read_light(const Node& node) {
    Light light;
    const std::string type = node["type"].json.get<std::string>();
    light.color = vec3_or(node, "color", light.color);
    light.intensity = number_or(node, "intensity", light.intensity);
    light.shadows = bool_or(node, "shadows", light.shadows);
    if (type == "directional") {
        light.type = Light::Type::kDirectional;
        light.direction = read_direction(node["direction"]);
    } else if (type == "point") {
        light.type = Light::Type::kPoint;
        light.position = to_vec3(node["position"].json);
    }
    return light;
}

RenderSettings read_render(const Node& scene) {
    RenderSettings render;
    if (!scene.has("render")) return render;
    const Node node = scene["render"];
    render.max_depth = int_or(node, "maxDepth", render.max_depth);
    render.max_error = number_or(node, "maxError", render.max_error);
    render.fresnel = bool_or(node, "fresnel", render.fresnel);
    if (node.has("paths")) {
        const auto named = [&](const char* path) {
            const Json& paths = node.json.at("paths");
            return std::find(paths.begin(), paths.end(), path) != paths.end();
        };
        render.direct = named("direct");
        render.reflect = named("reflect");
        render.refract = named("refract");
    }
    return render;
}

Material read_material(const Node& node, Reading& reading) {
    Material material;
    material.name = node["name"].json.get<std::string>();
    if (material.name == "inherit")
        node["name"].fail("'inherit' is taken: it stands for a file's own materials");
    material.base_color_factor = vec3_or(node, "baseColorFactor", material.base_color_factor);
    if (node.has("baseColorTexture"))
        material.base_color_texture = read_picture(reading, node["baseColorTexture"]);
    material.unlit = bool_or(node, "unlit", material.unlit);
    material.metallic_factor = number_or(node, "metallicFactor", material.metallic_factor);
    material.roughness_factor = number_or(node, "roughnessFactor", material.roughness_factor);
    material.transmission_factor = number_or(node, "transmissionFactor", material.transmission_factor);
    material.ior = number_or(node, "ior", material.ior);
    material.dispersion = number_or(node, "dispersion", material.dispersion);
    if (node.has("volume")) {
        const Node volume = node["volume"];
        material.attenuation_color = vec3_or(volume, "attenuationColor", material.attenuation_color);
        material.attenuation_distance =
            number_or(volume, "attenuationDistance", material.attenuation_distance);
    }
    return material;
}

}  // namespace trilens
