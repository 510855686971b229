// Lenses out of checked JSON: sides of primitives, rows of prescriptions, and files of optics programs.
#include "scene/read/read_lens.h"

#include <filesystem>

#include "json/schema.h"
#include "scene/formats/lens_file.h"
#include "scene/formats/line_scanner.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// A side as it is written.
struct WrittenSide {
    double radius = 0;  // 0: flat
    double conic = 0, aperture = 1;
};

const std::vector<Field<WrittenSide>>& side_fields() {
    static const std::vector<Field<WrittenSide>> fields{
        setting("radius", &WrittenSide::radius, ref("number"),
                "Of curvature at the vertex, positive where its centre lies farther along the axis; without "
                "it, or 0: flat.")
            .without_default(),
        setting("conic", &WrittenSide::conic, ref("number"), "-1: a paraboloid, 0: a sphere."),
        part<WrittenSide>(
            "coefficients",
            {{"type", "array"}, {"minItems", 1}, {"maxItems", kAsphereTerms}, {"items", ref("number")}},
            "Of r^2, r^4, ... r^16, added to the conicoid."),
        setting("aperture", &WrittenSide::aperture, ref("positive"), "Radius of its rim."),
    };
    return fields;
}

/// `json`: what it was read from.
LensSide side_of(const WrittenSide& written, const Json& json) {
    LensSide side{written.radius == 0 ? 0 : 1 / written.radius, written.conic, {}, written.aperture};
    if (!json.contains("coefficients")) return side;
    const Json& coefficients = json.at("coefficients");
    for (std::size_t i = 0; i < coefficients.size(); ++i)
        side.coefficients[i] = coefficients[i].get<double>();
    return side;
}

}  // namespace

void from_json_value(const Json& json, LensSide& side) {
    WrittenSide written;
    const std::string nowhere;
    read_fields(Node{json, "", nowhere}, side_fields(), written);
    side = side_of(written, json);
}
Json lens_side_schema() {
    return object_schema(
        {.title = "a lens' side",
         .description = "c r^2 / (1 + sqrt(1 - (1 + conic) c^2 r^2)) along the axis at r from it, c = 1 / "
                        "radius; and the terms of an even asphere.",
         .required = {"aperture"}},
        side_fields());
}

namespace {

struct WrittenRow {
    WrittenSide side = {.aperture = 0};
    double thickness = 0, ior = 1, abbe = 0;
    bool stop = false;
};

const std::vector<Field<WrittenRow>>& row_fields() {
    static const std::vector<Field<WrittenRow>> fields = [] {
        std::vector<Field<WrittenRow>> list;
        for (const Field<WrittenSide>& field : side_fields()) {
            list.push_back(within(&WrittenRow::side, field));
            if (field.key == "aperture") list.back().schema.erase("default");
        }
        list.push_back(setting("thickness", &WrittenRow::thickness, ref("notNegative"),
                               "To the next surface, along the axis."));
        list.push_back(
            part<WrittenRow>("glass", some_text(),
                             "What follows: a name of the catalogue (N-BK7), or a code of index and "
                             "Abbe number (517642); without it and 'ior': air."));
        list.push_back(setting("ior", &WrittenRow::ior, number_in(1, 10), "What follows, by its index.")
                           .without_default());
        list.push_back(setting("abbe", &WrittenRow::abbe, ref("positive"),
                               "Its Abbe number; without it, all colours have that index.")
                           .without_default());
        list.push_back(setting("stop", &WrittenRow::stop, yes_or_no(),
                               "The aperture stop: in air, a black ring around its aperture."));
        return list;
    }();
    return fields;
}

/// A lens as it is written, but for its surfaces.
struct WrittenLens {
    std::string name;
    int resolution = Mesh().resolution;
    bool dispersion = true;
};

const std::vector<Field<WrittenLens>>& written_lens_fields() {
    static const std::vector<Field<WrittenLens>> fields{
        setting("name", &WrittenLens::name, ref("name")).without_default(),
        part<WrittenLens>("file", some_text(),
                          "A Zemax file (.zmx), a CODE V sequence (.seq), or JSON with 'surfaces'."),
        part<WrittenLens>("surfaces", list_of(ref("lensSurface"), 2),
                          "From the front, which is at the origin, along +z; air before the first."),
        setting("resolution", &WrittenLens::resolution, whole_in(1, kMaxResolution), "As of optics."),
        setting("dispersion", &WrittenLens::dispersion, yes_or_no(),
                "Whether its glasses part light by their Abbe numbers."),
        part<WrittenLens>("transform", ref("transform")),
    };
    return fields;
}

}  // namespace

Json lens_surface_schema() {
    Json schema = object_schema({.title = "a surface of a lens",
                                 .description = "A row of a prescription: a side, and what follows it."},
                                row_fields());
    schema.update(parse_json(
        R"json({
  "dependencies": { "abbe": ["ior"] },
  "if": { "required": ["glass"] },
  "then": { "title": "a surface with a glass", "properties": { "ior": false } }
})json",
        "the rules of surfaces"));
    return schema;
}

Json lens_schema() {
    Json schema = object_schema(
        {.title = "a lens",
         .description = "A prescription. Each of its bodies of glass becomes an optic, its stop an object: "
                        "meshes behind those of the scene, with the lens' name, a slash and their number."},
        written_lens_fields());
    schema.update(
        parse_json(R"json({ "oneOf": [ { "required": ["surfaces"] }, { "required": ["file"] } ] })json",
                   "the rules of lenses"));
    return schema;
}

namespace {

LensPrescription read_surfaces(const Node& surfaces) {
    LensPrescription lens;
    lens.file = surfaces.file;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const Node node = surfaces[i];
        WrittenRow written;
        read_fields(node, row_fields(), written);
        LensRow& row = lens.rows.emplace_back();
        row.side = side_of(written.side, node.json);
        row.thickness = written.thickness;
        row.stop = written.stop;
        row.place = node.place;
        if (node.has("glass"))
            row.glass = find_glass(node["glass"].json.get<std::string>(), node.file, node["glass"].place);
        else if (node.has("ior"))
            row.glass = {describe(written.ior), written.ior, written.abbe};
    }
    check_prescription(lens);
    return lens;
}

LensPrescription parse_lens_json(const std::string& bytes, const std::string& file) {
    const Json json = parse_json(bytes, file);
    const Json& whole = scene_schema_json();
    Json alone = whole.at("definitions").at("lens");
    alone["definitions"] = whole.at("definitions");
    if (const auto found = find_problem(json, alone)) fail_at(file, found->place, found->message);
    const Node root{json, "", file};
    if (!root.has("surfaces")) root["file"].fail("a lens file has its own 'surfaces'");
    LensPrescription lens = read_surfaces(root["surfaces"]);
    lens.name = string_or(root, "name", "");
    return lens;
}

}  // namespace

LensPrescription parse_lens(const std::string& bytes, const std::string& file) {
    const std::string ending = in_capitals(std::filesystem::path(file).extension().string());
    LensPrescription lens;
    if (ending == ".ZMX")
        lens = parse_zemax(bytes, file);
    else if (ending == ".SEQ")
        lens = parse_code_v(bytes, file);
    else if (ending == ".JSON")
        lens = parse_lens_json(bytes, file);
    else
        throw InputError(file, "", "is no lens file: its name ends neither in .zmx nor .seq nor .json");
    if (lens.name.empty()) lens.name = std::filesystem::path(file).stem().string();
    return lens;
}

ReadLens read_lens(const Node& node, std::size_t index, Reading& reading) {
    WrittenLens written;
    written.name = "lens" + std::to_string(index);
    read_fields(node, written_lens_fields(), written);
    ReadLens lens{{}, written.name, written.resolution, written.dispersion};
    if (node.has("surfaces")) {
        lens.prescription = read_surfaces(node["surfaces"]);
        return lens;
    }
    const std::string path = reading.resolve(node["file"].json.get<std::string>());
    try {
        lens.prescription = parse_lens(reading.read_file(path), path);
    } catch (const InputError& error) {
        node["file"].fail(error.what());
    }
    return lens;
}

}  // namespace trilens
