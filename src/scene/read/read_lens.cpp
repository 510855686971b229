// Lenses out of checked JSON: sides of primitives, rows of prescriptions, and files of optics programs.
#include "scene/read/read_lens.h"

#include <filesystem>

#include "base/files/files.h"
#include "json/schema.h"
#include "lens/dispersion.h"
#include "lens/q_asphere.h"
#include "scene/formats/lens_file.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

/// A side as it is written.
struct WrittenSide {
    double radius = 0;  // 0: flat
    double conic = 0, aperture = 1;
    double normalization_radius = 0;   // 0: the aperture
    double x_radius = 0, x_conic = 0;  // of a biconic; radius 0: flat
    double rotation_radius = 0;        // of a toric side; 0: a cylinder
    LensSection profile = LensSection::kY;
};

Json terms(std::size_t most) {
    return {{"type", "array"}, {"minItems", 1}, {"maxItems", most}, {"items", ref("number")}};
}

const std::vector<Field<WrittenSide>>& side_fields() {
    static const std::vector<Field<WrittenSide>> fields{
        setting("radius", &WrittenSide::radius, ref("number"),
                "Of curvature at the vertex, positive where its centre lies farther along the axis; without "
                "it, or 0: flat.")
            .without_default(),
        setting("conic", &WrittenSide::conic, ref("number"), "-1: a paraboloid, 0: a sphere."),
        part<WrittenSide>("coefficients", terms(kAsphereTerms),
                          "Of r^2, r^4, ... r^16, added to the conicoid."),
        part<WrittenSide>(
            "normalDepartures", terms(kAsphereTerms),
            "Of r^2, r^4, ... r^16, over sqrt(1 - r^2 / radius^2): along the sphere's normals."),
        part<WrittenSide>("qcon", terms(kQTerms),
                          "Forbes' strong asphere, a0, a1, ...: added to the coefficients."),
        part<WrittenSide>("qbfs", terms(kQTerms),
                          "Forbes' mild asphere, a0, a1, ...: added to the departures; needs a sphere."),
        setting("normalizationRadius", &WrittenSide::normalization_radius, ref("positive"),
                "Of qcon and qbfs, where their u is 1; without it, the aperture.")
            .without_default(),
        setting(
            "radiusX", &WrittenSide::x_radius, ref("number"),
            "Makes it a biconic, whose radius and conic are those along y: of curvature along x; 0: flat.")
            .without_default(),
        setting("conicX", &WrittenSide::x_conic, ref("number"), "Of a biconic, along x."),
        setting("rotationRadius", &WrittenSide::rotation_radius, ref("number"),
                "Makes it toric: its profile, by radius, conic and coefficients, is turned about a line "
                "across the axis at this distance, positive behind the surface; 0: a cylinder.")
            .without_default(),
        choice("profileAlong", &WrittenSide::profile,
               "The axis along which a toric side's profile lies; it is turned about a line parallel to it."),
        setting("aperture", &WrittenSide::aperture, ref("positive"), "Radius of its rim.").without_default(),
    };
    return fields;
}

void add_terms(const Json& json, const char* key, std::array<double, kAsphereTerms>& to) {
    if (!json.contains(key)) return;
    for (std::size_t i = 0; i < json.at(key).size(); ++i) to[i] += json.at(key)[i].get<double>();
}

/// A Q-type asphere's terms; `of` makes polynomials of them.
template <typename Of>
void add_q_terms(const Node& node, const char* key, const WrittenSide& written, const Of& of,
                 std::array<double, kAsphereTerms>& to) {
    if (!node.has(key)) return;
    const double radius = written.normalization_radius > 0 ? written.normalization_radius : written.aperture;
    if (!(radius > 0)) node[key].fail("needs an aperture or a normalizationRadius");
    const auto a = node[key].json.get<std::vector<double>>();
    const std::array<double, kAsphereTerms> added = of(a, radius);
    for (std::size_t i = 0; i < kAsphereTerms; ++i) to[i] += added[i];
}

/// `node`: what it was read from.
LensSide side_of(const WrittenSide& written, const Node& node) {
    LensSide side{written.radius == 0 ? 0 : 1 / written.radius, written.conic, {}, written.aperture};
    add_terms(node.json, "coefficients", side.coefficients);
    add_terms(node.json, "normalDepartures", side.normal_departures);
    add_q_terms(node, "qcon", written, qcon_coefficients, side.coefficients);
    add_q_terms(node, "qbfs", written, qbfs_departures, side.normal_departures);
    if (node.has("qcon") || node.has("qbfs")) side.terms_radius = written.normalization_radius;
    if (node.has("radiusX") || node.has("conicX")) {
        side.form = SideForm::kBiconic;
        side.across_curvature = written.x_radius == 0 ? 0 : 1 / written.x_radius;
        side.across_conic = written.x_conic;
    } else if (node.has("rotationRadius")) {
        side.form = written.profile == LensSection::kY ? SideForm::kToricY : SideForm::kToricX;
        side.across_curvature = written.rotation_radius == 0 ? 0 : 1 / written.rotation_radius;
    }
    return side;
}

/// Keys beside each other that say different things of a side's form.
void check_form(const Node& side) {
    const auto refuse = [&side](std::initializer_list<const char*> keys, const char* why) {
        for (const char* key : keys)
            if (side.has(key)) side[key].fail(why);
    };
    const bool is_biconic = side.has("radiusX") || side.has("conicX");
    if (side.has("conicX") && !side.has("radiusX")) side["conicX"].fail("needs a radiusX beside it");
    if (is_biconic) refuse({"rotationRadius"}, "stands beside radiusX: a side is biconic or toric");
    if (is_biconic) refuse({"coefficients"}, "has no place on a biconic side");
    if (is_biconic || side.has("rotationRadius"))
        refuse({"normalDepartures", "qcon", "qbfs"}, "is of a side of revolution alone");
    if (!side.has("rotationRadius")) refuse({"profileAlong"}, "needs a rotationRadius beside it");
}

}  // namespace

void check_lens_side(const Node& side) {
    check_form(side);
    if (!side.has("conic") || side["conic"].json.get<double>() == 0) return;
    for (const char* key : {"qbfs", "normalDepartures"})
        if (side.has(key)) side[key].fail("departs from a sphere: the side's conic must be 0");
}

void from_json_value(const Json& json, LensSide& side) {
    WrittenSide written;
    const std::string nowhere;
    const Node node{json, "", nowhere};
    read_fields(node, side_fields(), written);
    side = side_of(written, node);
}

Json lens_side_schema() {
    return object_schema(
        {.title = "a lens' side",
         .description = "c r^2 / (1 + sqrt(1 - (1 + conic) c^2 r^2)) along the axis at r from it, c = 1 / "
                        "radius; and the terms of an even or a Q-type asphere. With radiusX a biconic, "
                        "with rotationRadius a toric side.",
         .required = {"aperture"}},
        side_fields());
}

namespace {

struct WrittenRow {
    WrittenSide side = {.aperture = 0};
    double thickness = 0, ior = 1, abbe = 0, hole = 0, obscuration = 0;
    bool stop = false, mirror = false;
    LensTilt tilt;
};

const std::vector<Field<LensTilt>>& tilt_fields() {
    static const std::vector<Field<LensTilt>> fields{
        setting("decentre", &LensTilt::decentre, ref("vec3"), "Of the surface, along the axes so far."),
        setting("tilt", &LensTilt::degrees, ref("vec3"),
                "Degrees about x, then about the new y, then about the new z, right-handed; after decentre."),
        choice(
            "axisBehind", &LensTilt::behind,
            "How the axis goes on: tilted as the surface, as before it, or along what the mirror reflects; "
            "reverses: only what follows is tilted, backwards."),
    };
    return fields;
}

const std::vector<Field<WrittenRow>>& row_fields() {
    static const std::vector<Field<WrittenRow>> fields = [] {
        std::vector<Field<WrittenRow>> list;
        for (const Field<WrittenSide>& field : side_fields())
            list.push_back(within(&WrittenRow::side, field));
        list.push_back(setting("thickness", &WrittenRow::thickness, ref("number"),
                               "To the next surface, along the axis; negative behind an odd number of "
                               "mirrors."));
        list.push_back(
            part<WrittenRow>("glass", some_text(),
                             "What follows: a name of the catalogue (N-BK7), or a code of index and "
                             "Abbe number (517642); without it and 'ior': air."));
        list.push_back(setting("ior", &WrittenRow::ior, number_in(1, 10), "What follows, by its index.")
                           .without_default());
        list.push_back(setting("abbe", &WrittenRow::abbe, ref("positive"),
                               "Its Abbe number; without it, all colours have that index.")
                           .without_default());
        list.push_back(part<WrittenRow>("sellmeier", several(6, ref("number")),
                                        "What follows, by K1, L1, K2, L2, K3, L3 of Sellmeier's formula, "
                                        "wavelengths in micrometres."));
        list.push_back(setting("stop", &WrittenRow::stop, yes_or_no(),
                               "The aperture stop: in air, a black ring around its aperture."));
        list.push_back(setting("mirror", &WrittenRow::mirror, yes_or_no(),
                               "Reflects; light stays in what it came through."));
        list.push_back(
            setting("hole", &WrittenRow::hole, ref("notNegative"),
                    "Radius of a hole in a mirror's middle; other surfaces stop the light there."));
        list.push_back(setting("obscuration", &WrittenRow::obscuration, ref("notNegative"),
                               "Radius of what stops light in the surface's middle: a black shell over it."));
        for (const Field<LensTilt>& field : tilt_fields()) list.push_back(within(&WrittenRow::tilt, field));
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
        part<WrittenLens>("glasses", some_text(),
                          "A catalogue of glasses (.agf), whose names come before those that are built in."),
        part<WrittenLens>("surfaces", list_of(ref("lensSurface"), 1),
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
  "allOf": [
    { "if": { "required": ["glass"] },
      "then": { "title": "a surface with a glass", "properties": { "ior": false, "sellmeier": false } } },
    { "if": { "required": ["sellmeier"] },
      "then": { "title": "a surface with a formula", "properties": { "ior": false } } },
    { "if": { "required": ["mirror"], "properties": { "mirror": { "const": true } } },
      "then": { "title": "a mirror", "properties": { "glass": false, "ior": false, "sellmeier": false } } }
  ]
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

Glass read_glass(const Node& row, const WrittenRow& written, std::span<const Glass> glasses) {
    if (row.has("glass"))
        return find_glass(row["glass"].json.get<std::string>(), row.file, row["glass"].place, glasses);
    if (row.has("sellmeier"))
        return sellmeier_glass("sellmeier", row["sellmeier"].json.get<SellmeierTerms>(), row.file,
                               row["sellmeier"].place);
    if (row.has("ior")) return {describe(written.ior), written.ior, written.abbe};
    return {};
}

LensPrescription read_surfaces(const Node& surfaces, std::span<const Glass> glasses) {
    LensPrescription lens;
    lens.file = surfaces.file;
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const Node node = surfaces[i];
        WrittenRow written;
        read_fields(node, row_fields(), written);
        LensRow& row = lens.rows.emplace_back();
        check_lens_side(node);
        row.side = side_of(written.side, node);
        row.thickness = written.thickness;
        row.stop = written.stop;
        row.place = node.place;
        row.mirror = written.mirror;
        row.hole = written.hole;
        row.obscuration = written.obscuration;
        if (written.tilt.behind == AxisBehind::kBends && !written.mirror)
            node["axisBehind"].fail("bends behind mirrors alone");
        tilt_row(row, written.tilt);
        row.glass = read_glass(node, written, glasses);
    }
    check_prescription(lens);
    return lens;
}

/// Throws InputError unless it is what the scene's schema defines by that name.
void check_defined(const Json& json, const std::string& file, const char* name) {
    const Json& definitions = scene_schema_json().at("definitions");
    Json alone = definitions.at(name);
    alone["definitions"] = definitions;
    if (const auto found = find_problem(json, alone)) fail_at(file, found->place, found->message);
}

LensPrescription parse_lens_json(const std::string& bytes, const std::string& file,
                                 std::span<const Glass> glasses) {
    const Json json = parse_json(bytes, file);
    if (json.is_object() && json.contains("version"))
        fail_at(
            file, "/version",
            "this is a scene: what is asked for is a prescription, as the 'file' or the 'surfaces' of one of "
            "its lenses");
    check_defined(json, file, "lens");
    const Node root{json, "", file};
    if (!root.has("surfaces")) root["file"].fail("a lens file has its own 'surfaces'");
    if (root.has("glasses")) root["glasses"].fail("are named beside a lens file, not in it");
    LensPrescription lens = read_surfaces(root["surfaces"], glasses);
    lens.name = string_or(root, "name", "");
    return lens;
}

}  // namespace

LensSide parse_side(const std::string& bytes, const std::string& file) {
    const Json json = parse_json(bytes, file);
    check_defined(json, file, "lensSide");
    check_lens_side({json, "", file});
    LensSide side;
    from_json_value(json, side);
    return side;
}

LensPrescription parse_lens(const std::string& bytes, const std::string& file,
                            std::span<const Glass> glasses) {
    const std::string ending = file_ending(file);
    LensPrescription lens;
    if (ending == ".zmx")
        lens = parse_zemax(bytes, file, glasses);
    else if (ending == ".seq")
        lens = parse_code_v(bytes, file, glasses);
    else if (ending == ".json")
        lens = parse_lens_json(bytes, file, glasses);
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
    std::vector<Glass> glasses;
    if (node.has("glasses")) {
        const std::string path = reading.resolve(node["glasses"].json.get<std::string>());
        try {
            glasses = parse_agf(reading.read_file(path), path);
        } catch (const InputError& error) {
            node["glasses"].fail(error.what());
        }
    }
    if (node.has("surfaces")) {
        lens.prescription = read_surfaces(node["surfaces"], glasses);
        return lens;
    }
    const std::string path = reading.resolve(node["file"].json.get<std::string>());
    try {
        lens.prescription = parse_lens(reading.read_file(path), path, glasses);
    } catch (const InputError& error) {
        node["file"].fail(error.what());
    }
    return lens;
}

}  // namespace trilens
