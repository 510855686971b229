// Wish files: their settings, each declared once, their schema, and their reader.
#include <filesystem>

#include "base/util/error.h"
#include "image/image_io.h"
#include "inverse/design/design.h"
#include "json/fields.h"
#include "json/json.h"
#include "json/schema.h"

namespace trilens {
namespace {

const std::vector<Field<MirrorPatch>>& patch_fields() {
    using P = MirrorPatch;
    static const std::vector<Field<P>> fields = [] {
        Field<P> controls =
            part<P>("controls", several(2, whole_in(4, 200)), "Control points of the B-spline along size.");
        controls.schema["default"] = {12, 12};
        controls.read = [](const Json& json, P& into) {
            into.controls = {json[0].get<int>(), json[1].get<int>()};
        };
        return std::vector<Field<P>>{
            setting("center", &P::center, ref("vec3"), "The middle of the mirror's rectangle, world."),
            setting("normal", &P::normal, ref("vec3"), "Towards the eye's side."),
            setting("tangent", &P::tangent, ref("vec3"), "Along the first of size."),
            setting("size", &P::size, several(2, ref("positive")), "Lengths of the rectangle's sides.")
                .without_default(),
            std::move(controls)};
    }();
    return fields;
}

const std::vector<Field<WishMap>>& map_fields() {
    using W = WishMap;
    static const std::vector<Field<W>> fields = [] {
        Field<W> window =
            part<W>("window", several(4, ref("number")),
                    "Longitudes and latitudes, degrees: west, south, east, north; latitudes within -90..90.");
        window.schema["default"] = {-45, -45, 45, 45};
        window.read = [](const Json& json, W& into) { from_json_value(json, into.window); };
        return std::vector<Field<W>>{
            choice("type", &W::type).without_default(),
            setting("origin", &W::origin, ref("vec3"),
                    "What is seen at s = 0, t = 0: of an eye straight before it the rectangle's corner "
                    "-tangent, -(normal x tangent).")
                .without_default()
                .of({"plane!"}),
            setting("u", &W::u, ref("vec3"), "From there along the tangent, all of it.")
                .without_default()
                .of({"plane!"}),
            setting("v", &W::v, ref("vec3"), "From there along normal x tangent.")
                .without_default()
                .of({"plane!"}),
            std::move(window).of({"equirectangular"}),
            setting("file", &W::file, {{"type", "string"}, {"minLength", 1}},
                    "An EXR with channels X, Y, Z: world points, or directions.")
                .of({"map!"}),
            setting("directions", &W::is_directions, yes_or_no(), "The map holds directions.").of({"map"})};
    }();
    return fields;
}

const std::vector<Field<DesignLens>>& lens_fields() {
    static const std::vector<Field<DesignLens>> fields{
        setting("ior", &DesignLens::ior, number_in(1, 10), "Of its glass, above 1."),
        setting("thickness", &DesignLens::thickness, ref("positive"),
                "From the rectangle to the back, a plane.")
            .without_default()};
    return fields;
}

const std::vector<Field<DesignWish>>& wish_fields() {
    using D = DesignWish;
    static const std::vector<Field<D>> fields = [] {
        Field<D> samples =
            part<D>("samples", several(2, whole_in(4, 400)), "Of the mirror, along both sides.");
        samples.schema["default"] = {40, 40};
        samples.read = [](const Json& json, D& into) {
            into.samples = {json[0].get<int>(), json[1].get<int>()};
        };
        Field<D> version = part<D>("version", {{"const", 1}});
        return std::vector<Field<D>>{
            std::move(version),
            setting("eye", &D::eye, ref("vec3"), "Who looks into the mirror, or through the lens, world.")
                .without_default(),
            part<D>("patch", ref("patch"), "The rectangle under the mirror."),
            part<D>("lens", ref("lens"),
                    "A lens instead of a mirror, its back a plane; what is designed is its front."),
            part<D>("wish", ref("wish"),
                    "What is seen at (s, t), 0..1 each over the mirror or lens as the eye sees it: in perspective "
                    "onto the plane through the rectangle's middle at right angles to the view, over its "
                    "foreshortened sides."),
            setting("anchor", &D::anchor, several(2, ref("number")),
                    "Where the mirror stays in the rectangle, from its middle, along both sides."),
            setting("fairness", &D::fairness, ref("notNegative"),
                    "Weight of the mean squared bend over the rectangle, against squared angles."),
            std::move(samples)};
    }();
    return fields;
}

const Json& wish_schema_json() {
    static const Json schema = [] {
        Json root = object_schema(
            {.title = "a wish",
             .description =
                 "What an eye is to see in a mirror or through a lens. Right-handed; any one length.",
             .required = {"version", "eye", "patch", "wish"}},
            wish_fields());
        Json whole = file_schema("trilens-wish-1", root);
        Json vec3{{"type", "array"}, {"minItems", 3}, {"maxItems", 3}, {"items", ref("number")}};
        whole["definitions"] = {
            {"number", number_in(-1e30, 1e30)},
            {"positive", number_above(0, 1e30)},
            {"notNegative", number_in(0, 1e30)},
            {"vec3", vec3},
            {"patch", object_schema({.title = "a patch", .required = {"center", "normal", "tangent", "size"}},
                                    patch_fields())},
            {"lens", object_schema({.title = "a lens", .required = {"thickness"}}, lens_fields())},
            {"wish", object_schema({.title = "a wish's map", .required = {"type"}, .kind_title = "a # wish"},
                                   map_fields())}};
        check_keywords(whole);
        return whole;
    }();
    return schema;
}

/// Rows of the file from the top; those of a wish from below.
void read_wish_map(const Node& node, const std::string& folder, WishMap& wish) {
    const std::string path = (std::filesystem::path(folder) / wish.file).string();
    const Image image = read_exr(path);
    std::array<const Channel*, 3> channels{};
    for (std::size_t k = 0; k < 3; ++k) {
        channels[k] = image.find(std::string(1, "XYZ"[k]));
        if (!channels[k] || channels[k]->is_id())
            throw InputError(path, std::string(1, "XYZ"[k]), "the map lacks this channel of floats");
    }
    if (image.data_width != image.width || image.data_height != image.height)
        node["file"].fail("the map's data window is not the whole picture");
    wish.columns = image.width, wish.rows = image.height;
    for (int row = image.height - 1; row >= 0; --row)
        for (int column = 0; column < image.width; ++column) {
            const auto at = static_cast<std::size_t>(row) * static_cast<std::size_t>(image.width) +
                            static_cast<std::size_t>(column);
            wish.values.emplace_back(channels[0]->floats()[at], channels[1]->floats()[at],
                                     channels[2]->floats()[at]);
        }
}

}  // namespace

std::string wish_schema() {
    return wish_schema_json().dump(2) + "\n";
}

std::string wish_example() {
    // A driver's mirror: 20 x 11 cm, the eye 0.87 m away and 29 degrees off axis, and a field of 45 degrees
    // of what lies 10 m behind, as a flat picture.
    return R"({ "version": 1,
  "eye": [0.4218, 0, 0.7609],
  "patch": { "center": [0, 0, 0], "normal": [0, 0, 1], "tangent": [1, 0, 0], "size": [0.2, 0.11], "controls": [12, 12] },
  "wish": { "type": "plane", "origin": [-7.652, -2.603, 7.654], "u": [7.65, 0, 3.169], "v": [0, 5.206, 0] },
  "fairness": 1e-10 }
)";
}

DesignWish parse_wish(const std::string& text, const std::string& name, const std::string& folder) {
    const Json json = parse_json(text, name);
    if (const auto found = find_problem(json, wish_schema_json()))
        fail_at(name, found->place, found->message);
    const Node root{json, "", name};
    DesignWish wish;
    read_fields(root, wish_fields(), wish);
    read_fields(root["patch"], patch_fields(), wish.patch);
    if (root.has("lens")) read_fields(root["lens"], lens_fields(), wish.lens.emplace());
    read_fields(root["wish"], map_fields(), wish.wish);
    if (wish.wish.type == WishType::kMap) read_wish_map(root["wish"], folder, wish.wish);
    check_wish(wish, name);
    return wish;
}

DesignWish read_wish(const std::string& file) {
    return parse_wish(read_required_file(file), file, std::filesystem::path(file).parent_path().string());
}

}  // namespace trilens
