// Film, background, materials and render settings out of checked JSON.
#include <algorithm>
#include <cmath>
#include <system_error>

#include "base/util/check.h"
#include "base/util/error.h"
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

const std::vector<Field<Film>>& film_fields() {
    static const std::vector<Field<Film>> fields{
        setting("width", &Film::width, whole_in(1, kMostFilmSide)),
        setting("height", &Film::height, whole_in(1, kMostFilmSide)),
        setting("spp", &Film::spp, whole_in(1, kMaxSpp), "S: S x S samples per pixel."),
        choice("filter", &Film::filter,
               "How samples make a pixel's colour: the mean of its own, or weighted with those of pixels "
               "around."),
    };
    return fields;
}

Json film_schema() {
    return object_schema({.title = "a film", .description = "At most 2^28 pixels."}, film_fields());
}

Film read_film(const Node& scene) {
    Film film;
    if (!scene.has("film")) return film;
    const Node node = scene["film"];
    read_fields(node, film_fields(), film);
    if (static_cast<long long>(film.width) * film.height > kMostPixels)
        node.fail(std::to_string(film.width) + " x " + std::to_string(film.height) +
                  " pixels are more than " + std::to_string(kMostPixels));
    return film;
}

namespace {

constexpr int kSkyColumns = 512, kSkyRows = 256;

/// A sky that needs no file: from the horizon's colour to the zenith's with the height of the direction over
/// the horizon, the sine of its elevation; one colour below.
struct WrittenSky {
    Vec3 zenith{0}, horizon{0}, ground{0};
};

std::shared_ptr<const Texture> draw_sky(const WrittenSky& sky) {
    auto texture = std::make_shared<Texture>();
    texture->width = kSkyColumns;
    texture->height = kSkyRows;
    for (int y = 0; y < kSkyRows; ++y) {
        const double height = std::cos(180 * kRadiansPerDegree * (y + 0.5) / kSkyRows);
        const Vec3 color = height > 0 ? sky.horizon + height * (sky.zenith - sky.horizon) : sky.ground;
        for (int x = 0; x < kSkyColumns; ++x)
            for (int c = 0; c < 3; ++c) texture->rgb.push_back(static_cast<float>(color[c]));
    }
    return texture;
}

}  // namespace

const std::vector<Field<Background>>& background_fields() {
    static const std::vector<Field<Background>> fields = [] {
        Field<Background> rotate = part<Background>("rotate", ref("number"));
        rotate.schema["default"] = 0;
        rotate.read = [](const Json& json, Background& background) {
            const double angle = std::remainder(json.get<double>(), 360) * kRadiansPerDegree;
            background.rotate_cos = std::cos(angle);
            background.rotate_sin = std::sin(angle);
        };
        return std::vector<Field<Background>>{
            setting("color", &Background::color, ref("color")),
            part<Background>("file", ref("name")),
            std::move(rotate),
            part<Background>("zenith", ref("color"), "Of a sky without a file: straight up."),
            part<Background>("horizon", ref("color")),
            part<Background>("ground", ref("color"), "Everywhere below the horizon.")};
    }();
    return fields;
}

Json background_schema() {
    Json schema = object_schema(
        {.title = "a background",
         .description =
             "A colour; a latitude-longitude picture turned about +Y by 'rotate' degrees; or a sky, from "
             "'horizon' to 'zenith' with the sine of the elevation, and 'ground' below."},
        background_fields());
    schema["dependencies"]["rotate"] = {"file"};
    for (const char* one : {"zenith", "horizon", "ground"})
        for (const char* other : {"zenith", "horizon", "ground"})
            if (std::string(one) != other) schema["dependencies"][one].push_back(other);
    const auto alone = [](const char* key, const char* title, std::vector<std::string> without) {
        Json rule{{"if", {{"required", {key}}}}, {"then", {{"title", title}}}};
        for (const std::string& other : without) rule["then"]["properties"][other] = false;
        return rule;
    };
    schema["allOf"] = {alone("file", "a background with a file", {"color", "zenith"}),
                       alone("zenith", "a background with a sky", {"color"})};
    return schema;
}

Background read_background(const Node& scene, Reading& reading) {
    Background background;
    if (!scene.has("background")) return background;
    const Node node = scene["background"];
    read_fields(node, background_fields(), background);
    if (node.has("file")) background.environment = read_picture(reading, node["file"]);
    if (node.has("zenith"))
        background.environment = draw_sky({.zenith = to_vec3(node["zenith"].json),
                                           .horizon = to_vec3(node["horizon"].json),
                                           .ground = to_vec3(node["ground"].json)});
    return background;
}

const std::vector<Field<RenderSettings>>& render_fields() {
    static const std::vector<Field<RenderSettings>> fields = [] {
        const std::vector<std::string> names{"direct", "reflect", "refract"};
        Field<RenderSettings> paths = part<RenderSettings>("paths", {{"type", "array"},
                                                                     {"minItems", 1},
                                                                     {"uniqueItems", true},
                                                                     {"items", word_of(names)},
                                                                     {"default", names}});
        paths.read = [](const Json& json, RenderSettings& render) {
            const auto named = [&](const char* path) {
                return std::find(json.begin(), json.end(), path) != json.end();
            };
            render.direct = named("direct");
            render.reflect = named("reflect");
            render.refract = named("refract");
        };
        return std::vector<Field<RenderSettings>>{
            setting("maxDepth", &RenderSettings::max_depth, whole_in(0, kMostDepth),
                    "Optic hits after the first; 0: paths end after their first optic, as if there were no "
                    "other."),
            std::move(paths),
            setting("fresnel", &RenderSettings::fresnel, yes_or_no()),
            setting("maxError", &RenderSettings::max_error, number_in(0, kMostMaxError),
                    "Pixels: facets whose predicted displacement against the exact paths is more are "
                    "divided, and at last traced; 0: they are as 'resolution' says, but for those that are "
                    "off by far more than facets of their size are: a pixel at 32 on a film 480 high, by the "
                    "square of both."),
            setting("roughSamples", &RenderSettings::rough_samples, whole_in(1, kMostRoughSamples),
                    "How many ways light takes over rough optics to each fragment that is projected; each "
                    "stands for a part of what their microfacets reflect."),
            setting("roughTruthSamples", &RenderSettings::rough_truth_samples, whole_in(1, kMostRoughSamples),
                    "The same of each pixel that is traced, shared among its samples; each is a ray."),
            setting("certify", &RenderSettings::certify, yes_or_no(),
                    "It is proven at each pixel's middle that what optics show is off by at most 'maxError', "
                    "which is above 0; what is not proven is traced.")};
    }();
    return fields;
}

Json render_schema() {
    return object_schema({.title = "render settings"}, render_fields());
}

RenderSettings read_render(const Node& scene) {
    RenderSettings render;
    if (scene.has("render")) read_fields(scene["render"], render_fields(), render);
    return render;
}

namespace {

const std::vector<Field<Material>>& volume_fields() {
    static const std::vector<Field<Material>> fields{
        setting("attenuationColor", &Material::attenuation_color, several(3, ref("share"))),
        setting("attenuationDistance", &Material::attenuation_distance, ref("notNegative"),
                "0: no absorption."),
    };
    return fields;
}

}  // namespace

const std::vector<Field<Material>>& material_fields() {
    static const std::vector<Field<Material>> fields = [] {
        Field<Material> strength =
            part<Material>("emissiveStrength", ref("notNegative"), "Factor of emissiveFactor.");
        strength.schema["default"] = 1;
        Field<Material> volume =
            part<Material>("volume", object_schema({.title = "a volume"}, volume_fields()));
        return std::vector<Field<Material>>{
            setting("name", &Material::name, {{"type", "string"}, {"minLength", 1}},
                    "Unique; 'inherit' is taken."),
            setting("baseColorFactor", &Material::base_color_factor, ref("color")),
            part<Material>("baseColorTexture", ref("texture")),
            setting("unlit", &Material::unlit, yes_or_no()),
            setting("metallicFactor", &Material::metallic_factor, ref("share")),
            setting(
                "roughnessFactor", &Material::roughness_factor, ref("share"),
                "Of an object: how dull its reflections of lights are; see 'brdf'. Of an optic, up to 0.3: "
                "how dull is what it mirrors or lets through; 0: it is polished."),
            choice(
                "brdf", &Material::brdf,
                "object: byRoughness: lambert where roughnessFactor is 0; lambert: matt; metallicRoughness: "
                "glTF's, which reflects lights, not other objects, and is polished at roughness 0. What "
                "mirrors its surroundings is an optic."),
            part<Material>("metallicRoughnessTexture", ref("texture"),
                           "Factors: green of roughness, blue of metallic; numbers, not colours."),
            part<Material>(
                "normalTexture", ref("texture"),
                "+X along u, +Y along v upward; numbers. An optic's normals are turned by it, too."),
            part<Material>("occlusionTexture", ref("texture"),
                           "Red: share of ambient and environment light that arrives; numbers."),
            setting("emissiveFactor", &Material::emissive_factor, ref("color"),
                    "Radiance of an object; it lights nothing else."),
            part<Material>("emissiveTexture", ref("texture"), "Factor of emissiveFactor."),
            std::move(strength),
            setting("specularFactor", &Material::specular_factor, ref("share"),
                    "Of an object with a roughness: how strongly what covers its colour reflects."),
            setting("specularColorFactor", &Material::specular_color_factor, ref("color")),
            setting("transmissionFactor", &Material::transmission_factor, ref("share")),
            setting("ior", &Material::ior, number_above(0, 10)),
            setting("dispersion", &Material::dispersion, ref("notNegative"),
                    "glTF's: 20 / Abbe number; light then parts into three colours."),
            std::move(volume),
            choice(
                "alphaMode", &Material::alpha_mode,
                "object: mask: what is less opaque than 'alphaCutoff' is not there, by the alpha channel of "
                "baseColorTexture times 'alphaFactor'; blend: by as much it hides what lies behind, and dims "
                "light; ids are of what lies behind."),
            setting("alphaCutoff", &Material::alpha_cutoff, number_in(0, 2)),
            setting("alphaFactor", &Material::alpha_factor, ref("share")),
            setting("doubleSided", &Material::double_sided, yes_or_no(),
                    "Of an object that blends: whether it is there for what looks at its back.")};
    }();
    return fields;
}

Json material_schema() {
    return object_schema(
        {.title = "a material",
         .description = "glTF's names. An optic needs metallicFactor 1 (mirror) or transmissionFactor 1 "
                        "(glass), and a roughnessFactor of at most 0.3.",
         .required = {"name"}},
        material_fields());
}

Material read_material(const Node& node, Reading& reading) {
    Material material;
    read_fields(node, material_fields(), material);
    if (material.name == "inherit")
        node["name"].fail("'inherit' is taken: it stands for a file's own materials");
    const PlacedTexture base = read_texture(node, "baseColorTexture", reading);
    const bool is_shared_out = material.alpha_mode != AlphaMode::kOpaque && base.picture;
    material.base_color_texture = is_shared_out ? with_straight_colours(base.picture) : base.picture;
    material.base_color_sampler = base.sampler;
    material.emissive_texture = read_texture(node, "emissiveTexture", reading);
    material.metallic_roughness_texture = read_number_texture(node, "metallicRoughnessTexture", reading);
    material.normal_texture = read_number_texture(node, "normalTexture", reading);
    material.occlusion_texture = read_number_texture(node, "occlusionTexture", reading);
    const auto of_texture = [&](const char* key, const char* own, double& value) {
        if (node.has(key) && node[key].json.is_object() && node[key].has(own))
            value = node[key].json.at(own).get<double>();
    };
    of_texture("normalTexture", "scale", material.normal_scale);
    of_texture("occlusionTexture", "strength", material.occlusion_strength);
    if (node.has("emissiveStrength")) material.emissive_factor *= node["emissiveStrength"].json.get<double>();
    if (node.has("volume")) read_fields(node["volume"], volume_fields(), material);
    return material;
}

}  // namespace trilens
