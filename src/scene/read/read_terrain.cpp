// Objects made of heights: the keys of terrains, and their triangles.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "base/util/check.h"
#include "base/util/error.h"
#include "scene/read/reading.h"
#include "terrain/terrain.h"

namespace trilens {
namespace {

constexpr double kMostNoData = std::numeric_limits<double>::max();

}  // namespace

const std::vector<Field<TerrainSettings>>& terrain_fields() {
    static const std::vector<Field<TerrainSettings>> fields{
        setting("heights", &TerrainSettings::heights, some_text(),
                "terrain: a picture whose first channel is heights over a grid: PNG, TIFF, OpenEXR. Its rows "
                "run along x, its columns along z, the middle at the origin. Integers without a sign are "
                "shares of the greatest, all others are numbers."),
        setting("size", &TerrainSettings::size, several(3, ref("positive")),
                "terrain: along x and z of the whole grid, along y of a height of 1.")
            .without_default(),
        setting(
            "noData", &TerrainSettings::no_data, number_in(-kMostNoData, kMostNoData),
            "terrain: the number of samples without a height, as the file has it (255 for the white of "
            "8 bits): the triangles that touch them are left out, as those that touch what is not finite.")
            .without_default(),
        setting("heightError", &TerrainSettings::height_error, ref("notNegative"),
                "terrain: how far along y, before transform, triangles may be from those of all samples; "
                "without it or a tolerance, all samples are kept.")
            .without_default(),
        setting("tolerance", &TerrainSettings::tolerance, ref("positive"),
                "terrain: how many pixels its triangles may be from those of all samples in the pictures of "
                "the scene's cameras, directly and by optics; instead of heightError, of which in pixels "
                "thinning and region then speak.")
            .without_default(),
        choice("thinning", &TerrainSettings::thinning,
               "terrain: bound: nothing is off by more than heightError, by the sum of linear wavelets; "
               "linear, haar: the energy of a wavelet's detail signal around a sample is to be above "
               "heightError squared, which bounds nothing."),
        part<TerrainSettings>("region", ref("region")),
    };
    return fields;
}

const std::vector<Field<InterestRegion>>& region_fields() {
    static const std::vector<Field<InterestRegion>> fields{
        setting("center", &InterestRegion::center, ref("vec2"), "x and z before transform."),
        setting("radii", &InterestRegion::radii, several(2, ref("positive")),
                "Along its two axes: where details count 1/e.")
            .without_default(),
        setting("turn", &InterestRegion::turn, ref("number"), "Degrees from x towards z of the first axis."),
    };
    return fields;
}

Json region_schema() {
    return object_schema({.title = "a region of interest",
                          .description = "Where a terrain's details count: by a Gaussian, 1 at its middle. "
                                         "What is off by as much as counts lies that much farther off.",
                          .required = {"radii"}},
                         region_fields());
}

namespace {

std::shared_ptr<const HeightGrid> read_heights(const Node& node, Terrain& terrain, Reading& reading) {
    terrain.file = reading.resolve(node.json.get<std::string>());
    std::error_code ignored;
    if (!std::filesystem::exists(terrain.file, ignored))
        node.fail("the picture '" + terrain.file + "' does not exist");
    TRILENS_CHECK(reading.textures.heights_from_file, "a scene with terrains needs a reader of heights");
    std::shared_ptr<const HeightGrid> heights;
    try {
        heights = std::make_shared<const HeightGrid>(reading.textures.heights_from_file(terrain.file));
    } catch (const InputError& error) {
        node.fail(error.what());
    }
    if (heights->columns < 2 || heights->rows < 2)
        node.fail("'" + terrain.file + "' has " + std::to_string(heights->columns) + " x " +
                  std::to_string(heights->rows) + " samples: a terrain has at least 2 x 2");
    if (heights->channels > 1)
        reading.warn(node.place, "'" + terrain.file + "' has " + std::to_string(heights->channels) +
                                     " channels: the heights are the first one");
    return heights;
}

/// Whether the file says so itself, in as many digits as it likes.
bool says_too(const HeightGrid& heights, double no_data) {
    if (!heights.no_data || heights.no_data == no_data) return heights.no_data.has_value();
    constexpr double kMost = std::numeric_limits<float>::max();
    const auto said = static_cast<float>(std::clamp(*heights.no_data, -kMost, kMost));
    return heights.greatest == 0 && heights.stands_for(said, no_data);
}

/// What a scene's `noData` makes of heights, and values that are none without it.
void check_numbers(const Node& node, const TerrainSettings& settings, const HeightGrid& heights,
                   Reading& reading) {
    const auto holds_nothing = [&](float value) {
        return node.has("noData") && heights.stands_for(value, settings.no_data);
    };
    const std::vector<float>& values = heights.values;
    if (node.has("noData") && !says_too(heights, settings.no_data) &&
        std::none_of(values.begin(), values.end(), holds_nothing))
        reading.warn(node["noData"].place, "no sample of '" + settings.heights + "' has that number");
    const auto far = std::find_if(values.begin(), values.end(), [&](float value) {
        return std::isfinite(value) && std::fabs(static_cast<double>(value)) > kLargestCoordinate &&
               !holds_nothing(value);
    });
    if (far == values.end()) return;
    const auto index = far - values.begin();
    node["heights"].fail("the sample in column " + std::to_string(index % heights.columns) + ", row " +
                         std::to_string(index / heights.columns) + " is " +
                         to_json_value(static_cast<double>(*far)).dump() +
                         ", beyond 1e30: if that is no height, say so by noData");
}

/// Of places of a mesh's own frame.
FilmMoves moves_of(const Transform& world_from_own, const FilmMoves& moves) {
    double stretch = 0;  // no direction is made longer by more: the root of the sum of squares
    for (int k = 0; k < 3; ++k) stretch += dot(world_from_own.linear[k], world_from_own.linear[k]);
    stretch = std::sqrt(stretch);
    return [=](std::span<const FilmMoveQuery> own) {
        std::vector<FilmMoveQuery> queries;
        for (const auto& [place, along, reach] : own)
            queries.push_back(
                {map_point(world_from_own, place), world_from_own.linear * along, stretch * reach});
        return moves(queries);
    };
}

TerrainMesh triangles_of(const Node& node, const TerrainSettings& settings, const HeightGrid& heights,
                         const Reading& reading) {
    TerrainShape shape{settings.size, {}};
    if (node.has("noData")) shape.no_data = settings.no_data;
    std::optional<Thinning> thinning;
    const char* limit = node.has("tolerance") ? "tolerance" : "heightError";
    if (node.has(limit)) {
        thinning = Thinning{settings.thinning, settings.height_error, {}, {}};
        if (node.has("tolerance")) {
            thinning->threshold = settings.tolerance;
            thinning->moves = moves_of(read_transform(node), reading.film_moves);
        }
        if (node.has("region")) read_fields(node["region"], region_fields(), thinning->region.emplace());
    }
    try {
        return make_terrain(heights, shape, thinning, reading.textures.progress);
    } catch (const std::length_error& error) {
        (thinning ? node[limit] : node["heights"])
            .fail(std::string("makes ") + error.what() + ": give a larger " + limit);
    }
}

}  // namespace

bool waits_for_views(const Node& mesh, const Reading& reading) {
    return mesh.has("tolerance") && !reading.film_moves;
}

void read_terrain(const Node& node, Mesh& mesh, Reading& reading) {
    TerrainSettings settings;
    read_fields(node, terrain_fields(), settings);
    auto terrain = std::make_shared<Terrain>();
    terrain->heights = read_heights(node["heights"], *terrain, reading);
    check_numbers(node, settings, *terrain->heights, reading);
    TerrainMesh made = triangles_of(node, settings, *terrain->heights, reading);
    terrain->missing_heights = made.missing_heights;
    terrain->whole_triangles = made.whole_triangles;
    terrain->greatest_error = made.greatest_error;
    terrain->rms_error = made.rms_error;
    if (made.triangles.empty()) node["heights"].fail("the terrain has no cell with four heights");
    if (made.missing_heights > 0)
        reading.warn(node["heights"].place,
                     std::to_string(made.missing_heights) +
                         " samples have no height: the triangles that touch them are left out");
    mesh.terrain = std::move(terrain);
    mesh.face_count = made.triangles.size();

    // Points and their normals alone: there is no face whose corners a mirroring transform could turn.
    PolygonMesh places;
    places.cage.points = std::move(made.points);
    places.normals = std::move(made.normals);
    place_mesh(places, node);
    const bool turned = mirrors(read_transform(node));
    const bool has_normals = read_shading(node) != ObjectShading::kFlatNormals;
    ObjectMesh& object = mesh.object;
    for (IdTriple& triangle : made.triangles) {
        if (turned) std::swap(triangle[1], triangle[2]);
        const auto& [a, b, c] = triangle;
        object.uvs.push_back({made.uvs[a], made.uvs[b], made.uvs[c]});
        if (has_normals) object.normals.push_back({places.normals[a], places.normals[b], places.normals[c]});
    }
    object.points = std::move(places.cage.points);
    object.triangles = std::move(made.triangles);
    object.material.assign(object.triangles.size(), kNone);
}

}  // namespace trilens
