// Textures out of checked JSON: a file's name, an object with the file and how it lies, or a pattern.
#include <algorithm>
#include <cmath>

#include "base/files/files.h"
#include "base/image/texture_lookup.h"
#include "base/math/luminance.h"
#include "base/math/srgb.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr int kPatternTexels = 1024;  // along a pattern's side, or somewhat more

/// Pictures that need no file. kChecker: squares of two colours in turn. kGrid: lines of the second colour
/// along the borders of squares of the first. kRamp: from the first on the left to the second on the right.
/// kRipples: waves across and down, one a square; kDimples: a round bowl in each square. Both from the first
/// colour, lowest, to the second, and without a step from square to square.
enum class Pattern { kChecker, kGrid, kRamp, kRipples, kDimples };

/// A texture as the scene writes it.
struct WrittenTexture {
    TextureSampler sampler;
    TextureTransform transform;
    Pattern pattern = Pattern::kChecker;
    std::array<int, 2> count{8, 8};
    double line = 0.1;
    bool heights = false;
};

}  // namespace

template <>
struct EnumNames<Pattern> {
    static constexpr std::array kTable{
        NamedValue<Pattern>{Pattern::kChecker, "checker"}, NamedValue<Pattern>{Pattern::kGrid, "grid"},
        NamedValue<Pattern>{Pattern::kRamp, "ramp"}, NamedValue<Pattern>{Pattern::kRipples, "ripples"},
        NamedValue<Pattern>{Pattern::kDimples, "dimples"}};
};

namespace {

const std::vector<Field<TextureTransform>>& transform_fields() {
    static const std::vector<Field<TextureTransform>> fields = [] {
        Field<TextureTransform> rotation = setting("rotation", &TextureTransform::rotation, ref("number"),
                                                   "Degrees, counter-clockwise (glTF's are radians).");
        rotation.read = [](const Json& json, TextureTransform& into) {
            into.rotation = json.get<double>() * 3.14159265358979323846 / 180;
        };
        return std::vector<Field<TextureTransform>>{setting("offset", &TextureTransform::offset, ref("vec2")),
                                                    std::move(rotation),
                                                    setting("scale", &TextureTransform::scale, ref("vec2"))};
    }();
    return fields;
}

Field<WrittenTexture> with_default(Field<WrittenTexture> field, double usual) {
    field.schema["default"] = to_json_value(usual);
    return field;
}

const std::vector<Field<WrittenTexture>>& texture_fields() {
    static const std::vector<Field<WrittenTexture>> fields = [] {
        const Json counts = several(2, whole_in(1, kPatternTexels));
        Field<WrittenTexture> count =
            part<WrittenTexture>("count", counts, "Squares across and down, of all but a ramp.");
        count.schema["default"] = {8, 8};
        count.read = [](const Json& json, WrittenTexture& into) {
            into.count = json.get<std::array<int, 2>>();
        };
        Field<WrittenTexture> colors =
            part<WrittenTexture>("colors", several(2, ref("color")), "The two colours of a pattern.");
        colors.schema["default"] = Json::parse("[[0, 0, 0], [1, 1, 1]]");
        return std::vector<Field<WrittenTexture>>{
            part<WrittenTexture>("file", ref("name"),
                                 "Of a picture: 8 and 16 bits are sRGB; or a glTF that holds pictures."),
            part<WrittenTexture>("image", ref("index"), "Of a glTF: its picture of that number."),
            choice("pattern", &WrittenTexture::pattern, "A picture that needs no file.").without_default(),
            std::move(colors),
            std::move(count),
            setting("line", &WrittenTexture::line, ref("share"), "Width of a grid's lines, of its squares."),
            within(&WrittenTexture::sampler,
                   choice("wrapS", &TextureSampler::wrap_s, "What lies left and right of the picture.")),
            within(&WrittenTexture::sampler,
                   choice("wrapT", &TextureSampler::wrap_t, "What lies above and below it.")),
            within(&WrittenTexture::sampler, setting("texCoord", &TextureSampler::uv_set, whole_in(0, 1),
                                                     "The mesh's set of uv: 0: 'uvs', 1: 'uvs1'.")),
            setting("heights", &WrittenTexture::heights, yes_or_no(),
                    "normalTexture: the picture holds heights; one of 1 is as high as a texel is wide."),
            with_default(part<WrittenTexture>("scale", ref("number"), "normalTexture: factor of its slopes."),
                         1),
            with_default(
                part<WrittenTexture>("strength", ref("share"), "occlusionTexture: how much it darkens."), 1),
            part<WrittenTexture>(
                "transform",
                object_schema({.title = "a texture's transform",
                               .description = "KHR_texture_transform: uv scaled, turned, moved."},
                              transform_fields()))};
    }();
    return fields;
}

/// How high a pattern of heights is at a place, 0..1; both in squares.
double pattern_height(Pattern pattern, double across, double down) {
    constexpr double kTurn = 2 * 3.14159265358979323846;
    if (pattern == Pattern::kRipples) return (2 + std::cos(kTurn * across) + std::cos(kTurn * down)) / 4;
    const double x = 2 * (across - std::floor(across)) - 1, y = 2 * (down - std::floor(down)) - 1;
    return std::min(x * x + y * y, 1.0);
}

std::shared_ptr<const Texture> draw_pattern(const WrittenTexture& written,
                                            const std::array<Vec3, 2>& colors) {
    const auto [columns, rows] = written.count;
    const bool ramp = written.pattern == Pattern::kRamp;
    const auto cell = [](int squares) { return (kPatternTexels + squares - 1) / squares; };
    auto texture = std::make_shared<Texture>();
    texture->width = ramp ? kPatternTexels : cell(columns) * columns;
    texture->height = ramp ? 1 : cell(rows) * rows;
    for (int y = 0; y < texture->height; ++y)
        for (int x = 0; x < texture->width; ++x) {
            double second = 0;  // the share of the second colour
            const double u = (x + 0.5) / texture->width, v = (y + 0.5) / texture->height;
            const double across = u * columns, down = v * rows;
            const auto on_line = [&](double at) { return std::fabs(at - std::round(at)) < written.line / 2; };
            if (ramp)
                second = u;
            else if (written.pattern == Pattern::kGrid)
                second = on_line(across) || on_line(down);
            else if (written.pattern != Pattern::kChecker)
                second = pattern_height(written.pattern, across, down);
            else
                second = (static_cast<int>(across) + static_cast<int>(down)) % 2;
            const Vec3 color = (1 - second) * colors[0] + second * colors[1];
            for (int c = 0; c < 3; ++c) texture->rgb.push_back(static_cast<float>(color[c]));
        }
    return texture;
}

}  // namespace

Json texture_schema() {
    Json schema = object_schema(
        {.title = "a texture", .description = "A picture's file, or how a picture lies."}, texture_fields());
    schema["type"] = {"string", "object"};
    schema["minLength"] = 1;
    schema["oneOf"] = Json::parse(R"([{"type": "string"}, {"type": "object", "required": ["file"]},
                                      {"type": "object", "required": ["pattern"]}])");
    return schema;
}

namespace {

/// What a picture's file holds, of the light that was made of it.
std::shared_ptr<const Texture> as_stored(const Texture& linear) {
    auto stored = std::make_shared<Texture>(linear);
    for (float& value : stored->rgb) value = static_cast<float>(srgb_from_linear(static_cast<double>(value)));
    return stored;
}

/// Whether files of this name hold light, and not values for a screen.
bool holds_light(const std::string& file) {
    const std::string ending = file_ending(file);
    return ending == ".exr" || ending == ".hdr";
}

/// What a picture's numbers mean.
enum class Meaning { kColours, kNumbers };

std::shared_ptr<const Texture> read_meant(const Node& file, Meaning meaning, Reading& reading) {
    std::shared_ptr<const Texture> picture = read_picture(reading, file);
    if (meaning == Meaning::kColours || holds_light(file.json.get<std::string>())) return picture;
    return as_stored(*picture);
}

/// The same of a picture that a glTF holds: its files are of values for a screen.
std::shared_ptr<const Texture> read_meant(const Node& file, const Node& image, Meaning meaning,
                                          Reading& reading) {
    std::shared_ptr<const Texture> picture = read_gltf_picture(reading, file, image);
    return meaning == Meaning::kColours ? picture : as_stored(*picture);
}

PlacedTexture read_texture(const Node& node, Meaning meaning, Reading& reading) {
    PlacedTexture texture;
    if (node.json.is_string()) {
        texture.picture = read_meant(node, meaning, reading);
        return texture;
    }
    WrittenTexture written;
    read_fields(node, texture_fields(), written);
    if (node.has("transform")) {
        read_fields(node["transform"], transform_fields(), written.transform);
        set_transform(written.transform, written.sampler);
    }
    texture.sampler = written.sampler;
    if (node.has("file")) {
        for (const char* key : {"colors", "count", "line"})
            if (node.has(key)) node[key].fail(std::string("'") + key + "' is of a pattern, not of a file");
        texture.picture = node.has("image") ? read_meant(node["file"], node["image"], meaning, reading)
                                            : read_meant(node["file"], meaning, reading);
        if (written.heights) texture.picture = normals_of_heights(*texture.picture, texture.sampler);
        return texture;
    }
    if (node.has("image")) node["image"].fail("'image' is of a glTF, not of a pattern");
    std::array<Vec3, 2> colors{Vec3(0), Vec3(1)};
    if (node.has("colors"))
        for (std::size_t k = 0; k < 2; ++k) colors[k] = to_vec3(node.json.at("colors").at(k));
    texture.picture = draw_pattern(written, colors);
    if (written.heights) texture.picture = normals_of_heights(*texture.picture, texture.sampler);
    return texture;
}

PlacedTexture read_key(const Node& material, const char* key, Meaning meaning, Reading& reading) {
    if (!material.has(key)) return {};
    const Node node = material[key];
    for (const auto& [own, of] : {std::pair("scale", "normalTexture"), std::pair("heights", "normalTexture"),
                                  std::pair("strength", "occlusionTexture")})
        if (node.json.is_object() && node.has(own) && std::string(key) != of)
            node[own].fail(std::string("'") + own + "' is of '" + of + "'");
    return read_texture(node, meaning, reading);
}

}  // namespace

std::shared_ptr<const Texture> read_numbers(Reading& reading, const std::string& path) {
    std::shared_ptr<const Texture> picture = read_picture(reading, path);
    return holds_light(path) ? picture : as_stored(*picture);
}

std::shared_ptr<const Texture> normals_of_heights(const Texture& heights, const TextureSampler& wrap) {
    const auto height = [&](int x, int y) {
        const int row = wrapped_texel(y, heights.height, wrap.wrap_t);
        const int column = wrapped_texel(x, heights.width, wrap.wrap_s);
        return luminance(texel_at(heights, column, row));
    };
    auto normals = std::make_shared<Texture>();
    normals->width = heights.width;
    normals->height = heights.height;
    for (int y = 0; y < heights.height; ++y)
        for (int x = 0; x < heights.width; ++x) {
            const Vec3 normal = normalize(Vec3((height(x - 1, y) - height(x + 1, y)) / 2,
                                               (height(x, y + 1) - height(x, y - 1)) / 2, 1));
            for (int k = 0; k < 3; ++k) normals->rgb.push_back(static_cast<float>((1 + normal[k]) / 2));
        }
    return normals;
}

std::shared_ptr<const Texture> with_straight_colours(std::shared_ptr<const Texture> picture) {
    if (!picture->is_premultiplied) return picture;
    auto straight = std::make_shared<Texture>(*picture);
    straight->is_premultiplied = false;
    for (std::size_t i = 0; i < straight->alpha.size(); ++i)
        if (straight->alpha[i] > 0)
            for (std::size_t c = 0; c < 3; ++c) straight->rgb[3 * i + c] /= straight->alpha[i];
    return straight;
}

PlacedTexture read_texture(const Node& material, const char* key, Reading& reading) {
    return read_key(material, key, Meaning::kColours, reading);
}

PlacedTexture read_number_texture(const Node& material, const char* key, Reading& reading) {
    return read_key(material, key, Meaning::kNumbers, reading);
}

}  // namespace trilens
