// The displacement of a mesh: the keys of heights that move its points, and those of an MTL's materials.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/util/format.h"
#include "base/util/names.h"
#include "scene/meshes/displacement.h"
#include "scene/meshes/weld.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

constexpr int kMostDivisions = 256;
/// Of the heights' range: what edges may pass over without a word.
constexpr double kSmallLoss = 0.1;

}  // namespace

const std::vector<Field<DisplacementSettings>>& displacement_fields() {
    static const std::vector<Field<DisplacementSettings>> fields{
        part<DisplacementSettings>("map", ref("texture"),
                                   "Its luminance is the height: of 8 and 16 bits 0..1, of OpenEXR and "
                                   "Radiance as they are. Without "
                                   "it, that of the materials of the mesh's MTL (disp)."),
        setting("scale", &DisplacementSettings::scale, ref("number"),
                "Factor of the map's heights, in the mesh's own units."),
        setting("offset", &DisplacementSettings::offset, ref("number"), "Added to all heights."),
        setting("subdivide", &DisplacementSettings::subdivide, whole_in(1, kMostDivisions),
                "object, and optic whose subdivisionScheme is none: N x N triangles for each of its "
                "triangles, before they are moved."),
    };
    return fields;
}

Json displacement_schema() {
    return object_schema({.title = "a displacement",
                          .description = "Heights that move a mesh's points along its smooth normals, before "
                                         "its transform; those of an optic's cage before it is subdivided."},
                         displacement_fields());
}

namespace {

/// Which heights move which faces; no maps: none do.
FaceHeights maps_of(const Node& mesh, const DisplacementSettings& settings, const PolygonMesh& polygons,
                    Reading& reading) {
    FaceHeights by;
    by.of_face.assign(polygons.cage.face_vertex_counts.size(), kNone);
    const bool has_node = mesh.has("displacement");
    if (has_node && mesh["displacement"].has("map")) {
        by.maps.push_back(
            {read_number_texture(mesh["displacement"], "map", reading), settings.scale, settings.offset});
        std::fill(by.of_face.begin(), by.of_face.end(), 0);
        return by;
    }
    if (polygons.face_material.empty()) return by;
    for (const HeightMap& heights : polygons.heights)
        by.maps.push_back({heights.texture, settings.scale * heights.scale,
                           settings.scale * heights.offset + settings.offset});
    for (std::size_t face = 0; face < by.of_face.size(); ++face) {
        const Id material = polygons.face_material[face];
        if (material < by.maps.size() && by.maps[material].texture.picture) by.of_face[face] = material;
    }
    if (std::all_of(by.of_face.begin(), by.of_face.end(), [](Id map) { return map == kNone; }))
        by.maps.clear();
    return by;
}

/// Cuts into triangles and divides those.
std::size_t divide(const Node& mesh, int n, PolygonMesh& polygons) {
    if (n < 2) return 0;
    const Node node = mesh["displacement"]["subdivide"];
    if (mesh.json.at("role") == "optic" && polygons.cage.scheme != SubdivisionScheme::kUnsubdivided)
        node.fail("an optic's cage is subdivided after its points are moved: give a finer cage");
    const std::size_t uncovered = cut_into_triangles(polygons);
    const std::size_t count = polygons.cage.face_vertex_counts.size() * static_cast<std::size_t>(n * n);
    if (count > kMostDisplacedTriangles)
        node.fail("makes " + std::to_string(count) + " triangles, more than " +
                  std::to_string(kMostDisplacedTriangles));
    divide_triangles(polygons, n);
    return uncovered;
}

/// Throws where a map has no uv to lie by.
void check_uvs(const Node& place, const FaceHeights& by, PolygonMesh& polygons, Reading& reading) {
    if (polygons.uvs.empty() && polygons.second_uvs.empty())
        place.fail("has no uv by which its displacement map could lie");
    const bool asks_second = std::any_of(by.maps.begin(), by.maps.end(), [](const HeightMap& map) {
        return map.texture.picture && map.texture.sampler.uv_set == 1;
    });
    if (asks_second && polygons.second_uvs.empty()) {
        reading.warn(place.place,
                     "the displacement map asks for a second set of uv, of which there is none: the first is "
                     "taken");
        polygons.second_uvs = polygons.uvs;
    }
    if (!asks_second && polygons.uvs.empty()) place.fail("has no uv by which its displacement map could lie");
}

void warn_of_loss(const Node& place, bool is_cage, const DisplacementLoss& loss, Reading& reading) {
    if (loss.without_normal > 0)
        reading.warn(place.place, std::to_string(loss.without_normal) +
                                      " points have no normal to be moved along: they stay");
    if (loss.greatest > kSmallLoss * loss.range)
        reading.warn(
            place.place,
            "between the points the map's heights are up to " + fmt::format("{:.3g}", loss.greatest) +
                " off what is drawn, of a range of " + fmt::format("{:.3g}", loss.range) +
                (is_cage ? ": a finer cage has more of them" : ": a larger 'subdivide' draws more of them"));
}

}  // namespace

std::size_t read_displacement(const Node& mesh, PolygonMesh& polygons, Reading& reading) {
    DisplacementSettings settings;
    const bool has_node = mesh.has("displacement");
    if (!has_node && polygons.heights.empty()) return 0;
    const Node place = has_node ? mesh["displacement"] : mesh["file"];
    if (has_node) read_fields(mesh["displacement"], displacement_fields(), settings);
    const std::size_t uncovered = divide(mesh, settings.subdivide, polygons);
    const FaceHeights by = maps_of(mesh, settings, polygons, reading);
    if (by.maps.empty()) {
        if (has_node) place.fail("has no 'map', nor has a material of the mesh's file (disp of an MTL)");
        return 0;
    }
    check_uvs(place, by, polygons, reading);
    const DisplacementLoss loss = displace(polygons, by);
    if (!trilens::place(polygons.cage.points, {})) place.fail("moves points beyond coordinates of 1e30");
    const bool is_cage =
        mesh.json.at("role") == "optic" && polygons.cage.scheme != SubdivisionScheme::kUnsubdivided;
    warn_of_loss(place, is_cage, loss, reading);
    return uncovered;
}

}  // namespace trilens
