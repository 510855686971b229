// Volumes out of checked JSON: cells of files, inline cells, grids of samples, and their transfer functions.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <utility>
#include <variant>

#include "base/files/files.h"
#include "base/math/box.h"
#include "base/util/names.h"
#include "scene/read/reading.h"
#include "scene/samples/volume_file.h"
#include "volume/cell_checks.h"
#include "volume/transfer_function.h"

namespace trilens {

const std::vector<Field<Volume>>& volume_entry_fields() {
    static const std::vector<Field<Volume>> fields{
        setting("name", &Volume::name, ref("name")).without_default(),
        part<Volume>(
            "file", some_text(),
            "Legacy VTK (.vtk), VTK's XML (.vtu), NRRD (.nrrd, .nhdr), or, with 'grid', samples as they "
            "lie in memory."),
        part<Volume>("field", some_text(),
                     "Of a VTK file: the scalar at its points of that name; without it, the first one."),
        part<Volume>("points", list_of(ref("vec3"), 4)),
        part<Volume>("scalars", list_of(ref("number"), 4), "One per point."),
        part<Volume>(
            "cells",
            list_of({{"type", "array"}, {"minItems", 4}, {"maxItems", 8}, {"items", ref("index")}}, 1),
            "Corners of each, in VTK's order: 4 of a tetrahedron, 5 of a pyramid, 6 of a wedge, 8 of "
            "a hexahedron."),
        part<Volume>("grid", ref("volumeGrid")),
        part<Volume>("transform", ref("transform")),
        part<Volume>("fit", ref("fit")),
        part<Volume>("transferFunction", ref("transferFunction")),
    };
    return fields;
}

namespace {

constexpr const char* kVolumeRules = R"json({
  "oneOf": [ { "required": ["points"] }, { "required": ["file"] },
             { "required": ["grid"], "properties": { "file": false } } ],
  "dependencies": { "points": ["scalars", "cells"], "scalars": ["points"], "cells": ["points"], "field": ["file"] }
})json";

constexpr const char* kTransferRules = R"json({
  "oneOf": [ { "required": ["points"] }, { "required": ["map", "extinction"] } ],
  "dependencies": { "range": ["map"], "extinction": ["map"] }
})json";

constexpr const char* kGridRules = R"json({
  "oneOf": [ { "required": ["scalars"] }, { "required": ["type"] } ],
  "dependencies": { "endian": ["type"], "skip": ["type"] }
})json";

/// A grid as JSON describes it.
struct GridText {
    Vec3 origin{0}, spacing{1};
};

const std::vector<Field<GridText>>& grid_fields() {
    static const std::vector<Field<GridText>> fields{
        part<GridText>("size", several(3, whole_in(2, 65536)), "Points along x, y and z; x runs fastest."),
        setting("origin", &GridText::origin, ref("vec3"), "Where the first point is."),
        setting("spacing", &GridText::spacing, several(3, ref("positive"))),
        part<GridText>("scalars", list_of(ref("number"), 8), "One per point."),
        part<GridText>("type", word_of(sample_type_names()), "Of the samples in 'file'."),
        part<GridText>("endian", word_of({"little", "big"}),
                       "Of samples of several bytes; little by default."),
        part<GridText>("skip", ref("index"),
                       "Bytes before the first sample; 0 by default. Behind the last there must be none."),
    };
    return fields;
}

/// A transfer function of a named map.
struct TransferText {
    double extinction = 0;
};

std::vector<Field<TransferText>> transfer_fields() {
    return {
        part<TransferText>("points", list_of(ref("transferPoint"), 1),
                           "Their values rise; linear between them, constant beyond."),
        part<TransferText>("map", word_of(color_map_names()),
                           "Colours of a map over 'range', its extinction rising from 0 at the lower end."),
        part<TransferText>("range", several(2, ref("number")),
                           "Values at the map's ends; by default the least and the greatest of the volume."),
        part<TransferText>("extinction", ref("notNegative"),
                           "Per world unit, at the map's upper end: light falls to 1/e over its inverse."),
    };
}

}  // namespace

const std::vector<Field<TransferPoint>>& transfer_point_fields() {
    static const std::vector<Field<TransferPoint>> fields{
        setting("value", &TransferPoint::value, ref("number")).without_default(),
        setting("color", &TransferPoint::color, ref("color"),
                "Radiance that an opaque volume of that value has.")
            .without_default(),
        setting("extinction", &TransferPoint::extinction, ref("notNegative"),
                "Per world unit: light falls to 1/e over its inverse.")
            .without_default(),
    };
    return fields;
}

Json volume_schema() {
    Json schema = object_schema(
        {.title = "a volume",
         .description =
             "Cells with a scalar at each vertex, which emit and absorb light by a transfer function; "
             "seen in the air, in front of what closes the ray, over any optic.",
         .required = {"transferFunction"}},
        volume_entry_fields());
    schema.update(parse_json(kVolumeRules, "the rules of volumes"));
    return schema;
}

Json volume_grid_schema() {
    Json schema = object_schema({.title = "a grid",
                                 .description = "A regular grid of samples: inline, or in the volume's file.",
                                 .required = {"size"}},
                                grid_fields());
    schema.update(parse_json(kGridRules, "the rules of grids"));
    return schema;
}

Json transfer_schema() {
    Json schema =
        object_schema({.title = "a transfer function",
                       .description = "Colour and extinction by the scalar: points, or a map of colours."},
                      transfer_fields());
    schema.update(parse_json(kTransferRules, "the rules of transfer functions"));
    return schema;
}

Json transfer_point_schema() {
    return object_schema(
        {.title = "a point of a transfer function", .required = {"value", "color", "extinction"}},
        transfer_point_fields());
}

namespace {

std::array<std::size_t, 3> read_size(const Node& grid) {
    std::array<std::size_t, 3> size{};
    for (std::size_t k = 0; k < 3; ++k) size[k] = grid["size"].json.at(k).get<std::size_t>();
    checked_point_count(size, grid.file, grid.place + "/size");
    return size;
}

/// A grid whose description stands in the scene.
RegularGrid read_grid(const Node& volume, Reading& reading) {
    const Node node = volume["grid"];
    RegularGrid grid;
    grid.size = read_size(node);
    GridText text;
    read_fields(node, grid_fields(), text);
    grid.origin = text.origin;
    for (int k = 0; k < 3; ++k) grid.steps[k][k] = text.spacing[k];
    const std::size_t count = grid.size[0] * grid.size[1] * grid.size[2];
    if (node.has("scalars")) {
        if (volume.has("file")) node["scalars"].fail("stand in the file that the volume names, or here");
        if (node["scalars"].size() != count)
            node["scalars"].fail("has " + std::to_string(node["scalars"].size()) +
                                 " entries, but the grid has " + std::to_string(count) + " points");
        grid.scalars = node["scalars"].json.get<std::vector<double>>();
        return grid;
    }
    if (!volume.has("file")) node["type"].fail("is of samples in a file, which the volume does not name");
    const std::vector<std::string>& types = sample_type_names();
    const auto type = std::find(types.begin(), types.end(), node["type"].json.get_ref<const std::string&>());
    SampleLayout layout;
    layout.type = static_cast<SampleType>(type - types.begin());
    layout.big_endian = string_or(node, "endian", "little") == "big";
    if (node.has("skip")) layout.skip = node["skip"].json.get<std::size_t>();
    const std::string path = reading.resolve(volume["file"].json.get<std::string>());
    grid.scalars = decode_samples(reading.read_file(path), path, grid.size, layout);
    return grid;
}

CellSoup read_inline_cells(const Node& node) {
    CellSoup soup;
    for (const Json& point : node["points"].json) soup.points.push_back(to_vec3(point));
    soup.scalars = node["scalars"].json.get<std::vector<double>>();
    if (soup.scalars.size() != soup.points.size())
        node["scalars"].fail("has " + std::to_string(soup.scalars.size()) + " entries for " +
                             std::to_string(soup.points.size()) + " points");
    const Node cells = node["cells"];
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const std::size_t corners = cells[c].size();
        switch (corners) {
            case 4:
                soup.shapes.push_back(CellShape::kTetrahedron);
                break;
            case 5:
                soup.shapes.push_back(CellShape::kPyramid);
                break;
            case 6:
                soup.shapes.push_back(CellShape::kWedge);
                break;
            case 8:
                soup.shapes.push_back(CellShape::kHexahedron);
                break;
            default:
                cells[c].fail("a cell has 4, 5, 6 or 8 corners");
        }
        for (std::size_t k = 0; k < corners; ++k) {
            const auto corner = cells[c].json.at(k).get<std::size_t>();
            if (corner >= soup.points.size())
                cells[c][k].fail("is no point: there are " + std::to_string(soup.points.size()));
            soup.corners.push_back(static_cast<Id>(corner));
        }
    }
    return soup;
}

std::variant<CellSoup, RegularGrid> read_cells(const Node& node, Volume& volume, Reading& reading) {
    if (node.has("grid")) return read_grid(node, reading);
    if (node.has("points")) return read_inline_cells(node);
    const std::string path = reading.resolve(node["file"].json.get<std::string>());
    const std::string ending = file_ending(path);
    if (ending == ".nrrd" || ending == ".nhdr") {
        if (node.has("field")) node["field"].fail("is of a VTK file: an NRRD has one field");
        return parse_nrrd(
            reading.read_file(path), path,
            [&](const std::string& name) {
                return reading.read_file((std::filesystem::path(path).parent_path() / name).string());
            },
            reading.textures.inflate);
    }
    if (ending != ".vtk" && ending != ".vtu")
        node["file"].fail(
            "is neither .vtk, .vtu, .nrrd nor .nhdr; samples as they lie in memory need a 'grid'");
    const std::string bytes = reading.read_file(path), field = string_or(node, "field", "");
    VolumeFile file = ending == ".vtk" ? parse_vtk(bytes, path, field)
                                       : parse_vtu(bytes, path, field, reading.textures.inflate);
    for (const std::string& warning : file.warnings) reading.warn(node["file"].place, warning);
    volume.field = file.field;
    return std::move(file.cells);
}

/// Moves the points; where the map mirrors, cells are turned.
void place(const Transform& transform, const Node& node, TetMesh& mesh) {
    if (!place(mesh.points, transform)) node.fail("its transform carries points beyond coordinates of 1e30");
    if (glm::determinant(transform.linear) < 0)
        for (Tetrahedron& cell : mesh.cells) std::swap(cell[2], cell[3]);
}

Transform fitting_transform(const Node& fit, const TetMesh& mesh) {
    Box bounds;
    for (const Vec3& point : mesh.points) bounds.include(point);
    const Vec3 sides = bounds.size();
    const double longest = std::max({sides.x, sides.y, sides.z});
    if (!(longest > 0)) fit.fail("the volume has no size that could be fitted");
    const double factor = fit["size"].json.get<double>() / longest;
    return {Mat3(factor), vec3_or(fit, "center", Vec3(0)) - factor * (0.5 * (bounds.low + bounds.high))};
}

TransferFunction read_points(const Node& node) {
    TransferFunction transfer;
    for (std::size_t i = 0; i < node.size(); ++i) {
        TransferPoint point;
        read_fields(node[i], transfer_point_fields(), point);
        if (i > 0 && !(point.value > transfer.points.back().value))
            node[i]["value"].fail("must be above the value of the point before it");
        transfer.points.push_back(point);
    }
    return transfer;
}

TransferFunction read_transfer(const Node& node, const std::vector<double>& scalars) {
    if (node.has("points")) return read_points(node["points"]);
    const std::vector<Vec3> colors = color_map(node["map"].json.get<std::string>());
    const auto [least, most] = std::minmax_element(scalars.begin(), scalars.end());
    double low = *least, high = *most;
    if (node.has("range")) {
        low = node["range"].json.at(0).get<double>();
        high = node["range"].json.at(1).get<double>();
        if (!(low < high)) node["range"].fail("must rise");
    } else if (!(low < high)) {
        node.fail("the volume has one value alone: give a 'range'");
    }
    const double extinction = node["extinction"].json.get<double>();
    TransferFunction transfer;
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const double share = static_cast<double>(i) / static_cast<double>(colors.size() - 1);
        transfer.points.push_back({low + share * (high - low), colors[i], share * extinction});
    }
    return transfer;
}

void warn_of(std::size_t count, const char* what, const Node& node, Reading& reading) {
    if (count > 0) reading.warn(node.place, std::to_string(count) + " " + what);
}

void warn_of_cells(const TetMesh& mesh, const Node& node, Reading& reading) {
    warn_of(mesh.counts.inverted, "tetrahedra are inverted: they are turned", node, reading);
    warn_of(mesh.counts.flat, "tetrahedra have no volume: they are left out", node, reading);
    warn_of(mesh.counts.folded, "cells fold over themselves: their tetrahedra overlap", node, reading);
    warn_of(mesh.counts.crowded, "faces are those of more than two cells: they overlap", node, reading);
    warn_of(mesh.counts.open,
            "faces touch a cell that does not have them: the mesh does not conform there, or cells overlap",
            node, reading);
}

Volume read_volume(const Node& node, std::size_t index, Reading& reading) {
    Volume volume;
    volume.name = "volume" + std::to_string(index);
    read_fields(node, volume_entry_fields(), volume);
    std::variant<CellSoup, RegularGrid> cells = read_cells(node, volume, reading);
    const bool is_grid = std::holds_alternative<RegularGrid>(cells);
    auto mesh =
        std::make_shared<TetMesh>(std::visit([](auto& one) { return make_tet_mesh(std::move(one)); }, cells));
    if (mesh->cells.empty()) node.fail("has no cell with a volume");
    if (mesh->cells.size() > kMostCells)
        node.fail("has " + std::to_string(mesh->cells.size()) + " tetrahedra, more than " +
                  std::to_string(kMostCells));
    place(read_transform(node), node, *mesh);
    if (node.has("fit")) place(fitting_transform(node["fit"], *mesh), node["fit"], *mesh);
    if (!is_grid) {
        const CellFaces faces = find_faces(*mesh, mesh->counts.crowded);
        mesh->counts.open = count_open_faces(*mesh, faces);
    }
    warn_of_cells(*mesh, node, reading);
    volume.transfer = read_transfer(node["transferFunction"], mesh->scalars);
    volume.cells = std::move(mesh);
    return volume;
}

}  // namespace

void read_volumes(const Node& scene, Reading& reading) {
    if (!scene.has("volumes")) return;
    std::set<std::string> names;
    const Node volumes = scene["volumes"];
    for (std::size_t i = 0; i < volumes.size(); ++i) {
        const Volume& volume = reading.scene.volumes.emplace_back(read_volume(volumes[i], i, reading));
        if (!names.insert(volume.name).second)
            (volumes[i].has("name") ? volumes[i]["name"] : volumes[i])
                .fail("the name '" + volume.name + "' is taken already");
    }
}

}  // namespace trilens
