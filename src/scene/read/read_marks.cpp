// Points and labels out of checked JSON.
#include <cmath>
#include <utility>

#include "scene/data/polygons.h"
#include "scene/read/reading.h"
#include "scene/samples/point_cloud.h"

namespace trilens {

const std::vector<Field<PointCloud>>& point_cloud_fields() {
    static const std::vector<Field<PointCloud>> fields{
        setting("name", &PointCloud::name, ref("name")).without_default(),
        part<PointCloud>("file", some_text(),
                         "PLY, or text with x,y,z or x,y,z,red,green,blue (linear) on each line."),
        part<PointCloud>("at", list_of(ref("vec3"), 1)),
        setting("color", &PointCloud::color, ref("color"),
                "The light of each point whose file gives it none, whatever shines on it."),
        setting("radius", &PointCloud::radius, ref("positive"),
                "World units: points are balls, as large as they are seen from wherever; instead of 'size'.")
            .without_default(),
        setting("size", &PointCloud::size, number_above(0, 1000), "Pixels across, however far they are."),
        setting("minWeight", &PointCloud::min_weight, ref("share"),
                "Images that carry a smaller share of the light in every colour are left out."),
        part<PointCloud>("transform", ref("transform")),
    };
    return fields;
}

namespace {

/// On or far off any film: what is computed of them stays exact to a small part of a pixel.
Json pixel_offset() {
    constexpr double kMost = 1e6;
    Json pair = list_of(number_in(-kMost, kMost), 2);
    pair["maxItems"] = 2;
    return pair;
}

}  // namespace

const std::vector<Field<Label>>& label_fields() {
    static const std::vector<Field<Label>> fields{
        within(&Label::style, setting("text", &TextStyle::text, some_text())).without_default(),
        setting("at", &Label::place, ref("vec3")).without_default(),
        setting("color", &Label::color, ref("color")),
        within(&Label::style, setting("size", &TextStyle::size, number_in(4, 500), "Pixels, of a line.")),
        setting("offset", &Label::offset, pixel_offset(),
                "Pixels right and down from the place to the left end of the text's middle line."),
        setting("dot", &Label::dot, number_in(0, 500), "Pixels across, at the place; 0: none."),
        setting("minWeight", &Label::min_weight, ref("share"),
                "Images that carry a smaller share of the light in every colour are left out."),
        setting("givesWay", &Label::gives_way, yes_or_no(),
                "Whether images of it that would cover another label's are left out."),
        setting("priority", &Label::priority, ref("number"),
                "Of labels that give way the higher ones stay; of equal ones what is nearer."),
        part<Label>("font", some_text(), "A TrueType file; without it DejaVu Sans."),
    };
    return fields;
}

Json point_cloud_schema() {
    Json schema = object_schema(
        {.title = "a point cloud",
         .description = "Points that are seen directly and over every optic, each image where it is exactly "
                        "and hidden by what stands before it; marks on the picture, that cast no shadow."},
        point_cloud_fields());
    schema.update(parse_json(R"json({
      "oneOf": [ { "required": ["file"] }, { "required": ["at"] } ],
      "if": { "required": ["radius"] }, "then": { "properties": { "size": false } }
    })json",
                             "the rules of point clouds"));
    return schema;
}

Json label_schema() {
    return object_schema(
        {.title = "a label",
         .description = "A text beside a place, on each of its images, directly and over every optic.",
         .required = {"text", "at"}},
        label_fields());
}

namespace {

PointCloud read_cloud(const Node& node, std::size_t index, Reading& reading) {
    PointCloud cloud;
    cloud.name = "points " + std::to_string(index);
    read_fields(node, point_cloud_fields(), cloud);
    if (node.has("file")) {
        const std::string path = reading.resolve(node["file"].json.get<std::string>());
        ColoredPoints read = parse_cloud(reading.read_file(path), path);
        cloud.places = std::move(read.points);
        cloud.colors = std::move(read.colors);
    } else {
        for (const Json& place : node["at"].json) cloud.places.push_back(to_vec3(place));
    }
    if (!place(cloud.places, read_transform(node)))
        node["transform"].fail("carries points beyond coordinates of 1e30");
    return cloud;
}

Label read_label(const Node& node, Reading& reading) {
    Label label;
    read_fields(node, label_fields(), label);
    if (node.has("font")) label.style.font = reading.resolve(node["font"].json.get<std::string>());
    if (!reading.textures.letters) return label;
    try {
        label.letters = std::make_shared<const TextMask>(reading.textures.letters(label.style));
    } catch (const InputError& fault) {
        node[node.has("font") ? "font" : "text"].fail(fault.what());
    }
    return label;
}

}  // namespace

void read_marks(const Node& scene, Reading& reading) {
    if (scene.has("points"))
        for (std::size_t i = 0; i < scene["points"].size(); ++i)
            reading.scene.points.push_back(read_cloud(scene["points"][i], i, reading));
    if (scene.has("labels"))
        for (std::size_t i = 0; i < scene["labels"].size(); ++i)
            reading.scene.labels.push_back(read_label(scene["labels"][i], reading));
}

}  // namespace trilens
