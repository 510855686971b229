// The settings of meshes: what they are, how optics are cut into facets, and the keys of their shapes.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/math/box.h"
#include "base/util/names.h"
#include "scene/data/alpha_cut.h"
#include "scene/data/cage_diagnostics.h"
#include "scene/data/vertex_normals.h"
#include "scene/data/weld.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

using MeshFields = std::vector<Field<Mesh>>;

Json text_value() {
    return {{"type", "string"}, {"minLength", 1}};
}

/// Read where the object's polygons are.
Field<Mesh> shading_field() {
    Json names = word_of(names_of<ObjectShading>());
    names["default"] = name_of(ObjectShading::kGivenNormals);
    return part<Mesh>(
        "shading", std::move(names),
        "object: given: lit by the normals that its file or primitive has, else flat; flat: by "
        "its triangles' own; smooth: where none are given, by the mean of the faces around each "
        "point.");
}

/// A terrain is an object.
Field<Mesh> role_field() {
    Field<Mesh> field = part<Mesh>("role", word_of({"object", "optic", "terrain"}));
    field.read = [](const Json& json, Mesh& mesh) {
        mesh.role = json == "optic" ? Role::kOptic : Role::kObject;
    };
    return field;
}

/// Keys that are read elsewhere.
template <typename Part>
void add_keys(const std::vector<Field<Part>>& of_part, MeshFields& fields) {
    for (const Field<Part>& field : of_part) {
        fields.emplace_back();
        static_cast<FieldSchema&>(fields.back()) = field;
    }
}

MeshFields all_mesh_fields() {
    MeshFields fields{
        setting("name", &Mesh::name, ref("name")),
        role_field(),
        part<Mesh>(
            "material", text_value(),
            "A name of 'materials'; 'inherit' (the default of an object from a file): the file's own."),
        setting("resolution", &Mesh::resolution, whole_in(1, kMaxResolution),
                "optic: N x N facets per quad face or patch; object of patches: N x N quads."),
        choice(
            "rays", &Mesh::rays,
            "optic: at the corners of its facets the exact rays, with straight interpolation between them, "
            "or rays fitted so that what lies between is nearest to exact in the mean."),
        choice("grid", &Mesh::grid,
               "optic: its facets lie on the surface, N x N per face, or on the film, N x N over its bounds "
               "there."),
        either("seenOptics", &Mesh::layered, {"divided", "layers"},
               "optic that mirrors: an optic seen in it is drawn as a layer, its own grid as this one shows "
               "it, where that can be; or this optic's facets are divided along its outline, and at last "
               "traced."),
        setting(
            "priority", &Mesh::priority, whole_in(-1000, 1000),
            "optic of glass: where bodies overlap the one of higher priority is inside, as a glass around "
            "its liquid."),
        shading_field(),
        part<Mesh>("transform", ref("transform")),
        part<Mesh>("fit", ref("fit")),
        part<Mesh>("file", text_value(), "OBJ, glTF or GLB."),
        part<Mesh>("node", ref("index"),
                   "Of a glTF: the mesh of its node of that number, in the world; without it, all nodes."),
        part<Mesh>("parts", list_of(ref("index"), 1), "Of a node: those of its mesh's primitives alone."),
        part<Mesh>("clip", ref("index"), "Of a glTF: its animation of that number."),
        part<Mesh>("time", ref("number"), "Of a clip: seconds."),
        part<Mesh>("primitive", ref("primitive")),
        part<Mesh>("patches", list_of(ref("patch"), 1),
                   "Spline patches, of an optic as they are, of an object as N x N quads each."),
        part<Mesh>("points", list_of(ref("vec3"), 3)),
        part<Mesh>("faceVertexCounts", list_of(whole_in(3, 255), 1)),
        part<Mesh>("faceVertexIndices", list_of(ref("index"), 3)),
        part<Mesh>("uvs", list_of(ref("vec2"), 1),
                   "v upward. One per entry of faceVertexIndices, or, with uvIndices, those it names."),
        part<Mesh>(
            "uvIndices", list_of(ref("index"), 3),
            "One per entry of faceVertexIndices; a copy of faceVertexIndices makes uvs one per point."),
        part<Mesh>("uvs1", list_of(ref("vec2"), 1),
                   "Of textures with texCoord 1, one per entry of faceVertexIndices."),
    };
    add_keys(subdivision_fields(), fields);
    add_keys(terrain_fields(), fields);
    fields.push_back(part<Mesh>("normals", ref("normals")));
    return fields;
}

// Which keys go together, whatever they hold.
constexpr const char* kMeshRules = R"json({
  "oneOf": [ { "required": ["points"] }, { "required": ["file"] }, { "required": ["primitive"] }, { "required": ["heights"] }, { "required": ["patches"] } ],
  "dependencies": {
    "heights": ["size"], "size": ["heights"], "noData": ["heights"], "heightError": ["heights"],
    "thinning": ["heightError"], "region": ["heightError"],
    "points": ["faceVertexCounts", "faceVertexIndices"], "faceVertexCounts": ["points"], "faceVertexIndices": ["points"],
    "uvIndices": ["uvs"], "creaseIndices": ["creaseSharpnesses"], "creaseSharpnesses": ["creaseIndices"],
    "node": ["file"], "parts": ["node"], "clip": ["file"], "time": ["clip"],
    "creaseLengths": ["creaseIndices"], "cornerIndices": ["cornerSharpnesses"], "cornerSharpnesses": ["cornerIndices"]
  },
  "allOf": [
    { "if": { "properties": { "role": { "const": "optic" } } },
      "then": { "title": "an optic", "required": ["material"], "properties": { "heights": false } } },
    { "if": { "properties": { "role": { "const": "terrain" } } },
      "then": { "title": "a terrain", "required": ["heights"] } },
    { "if": { "required": ["heights"] },
      "then": { "title": "a terrain", "properties": { "role": { "const": "terrain" }, "uvs": false, "uvIndices": false, "uvs1": false } } },
    { "if": { "required": ["file"] },
      "then": { "title": "a mesh with a file", "properties": { "uvs": false, "uvIndices": false } } },
    { "if": { "required": ["patches"] },
      "then": { "title": "a mesh of patches", "properties": { "uvs": false, "uvIndices": false, "uvs1": false, "subdivisionScheme": false, "interpolateBoundary": false,
        "creaseIndices": false, "cornerIndices": false, "holeIndices": false } } },
    { "if": { "required": ["primitive"] },
      "then": { "title": "a primitive", "properties": { "uvs": false, "uvIndices": false, "uvs1": false, "subdivisionScheme": false, "interpolateBoundary": false,
        "creaseIndices": false, "cornerIndices": false, "holeIndices": false } } }
  ]
})json";

}  // namespace

const std::vector<Field<Mesh>>& mesh_fields() {
    static const MeshFields fields = all_mesh_fields();
    return fields;
}

Json mesh_schema() {
    Json schema = object_schema(
        {.title = "a mesh",
         .description =
             "UsdGeomMesh's names. Objects are drawn as their polygons, optics as their limit "
             "surface: what an object has no use for (resolution, creases, normals) it ignores. No "
             "point of an optic's cage may lie more than 1e4 times as far from their middle (the "
             "median along each axis) as half of them do.",
         .required = {"role"}},
        mesh_fields());
    schema.update(parse_json(kMeshRules, "the rules of meshes"));
    return schema;
}

const std::vector<Field<NormalOverride>>& normal_fields() {
    static const std::vector<Field<NormalOverride>> fields{
        choice("type", &NormalOverride::type).without_default(),
        setting("center", &NormalOverride::center, ref("vec3"),
                "sphere: normals point away from it; world frame.")
            .of({"sphere"}),
        setting("seed", &NormalOverride::seed, ref("index")).of({"noise"}),
        setting("amplitude", &NormalOverride::amplitude, ref("notNegative")).of({"noise"}),
        setting("scale", &NormalOverride::scale, ref("positive")).of({"noise"}),
    };
    return fields;
}

Json normals_schema() {
    return object_schema({.title = "a normals override", .required = {"type"}, .kind_title = "# normals"},
                         normal_fields());
}

// One entry of `meshes`: its material, its shape as optic or object, and what is doubtful about it.

namespace {

bool inherits(const Node& node) {
    const std::string material = string_or(node, "material", node.has("file") ? "inherit" : "");
    if (material != "inherit") return false;
    if (!node.has("file")) node["material"].fail("only a mesh with a file has materials to inherit");
    return true;
}

/// Index into the scene's materials; kNone where the mesh names none, or inherits.
Id find_material(const Node& node, const Reading& reading) {
    if (!node.has("material") || node.json.at("material") == "inherit") return kNone;
    const std::string name = node["material"].json.get<std::string>();
    std::vector<std::string> known;
    for (std::size_t i = 0; i < reading.named_materials; ++i)
        known.push_back(reading.scene.materials[i].name);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end())
        node["material"].fail("unknown material '" + name + "'" + suggestion(name, known));
    return static_cast<Id>(found - known.begin());
}

void check_optic_material(const Node& node, Id index, Reading& reading) {
    if (index == kNone)
        node["material"].fail("an optic cannot inherit: name a mirror or a glass of 'materials'");
    const Material& material = reading.scene.materials[index];
    const bool mirror = material.metallic_factor == 1, glass = material.transmission_factor == 1;
    const std::string optic = "the material '" + material.name + "' of an optic ";
    if (!mirror && !glass)
        node["material"].fail(optic + "must be a mirror (metallicFactor 1) or glass (transmissionFactor 1)");
    if (mirror && glass) node["material"].fail(optic + "cannot be mirror and glass at once");
    if (material.roughness_factor != 0) node["material"].fail(optic + "must have roughnessFactor 0");
    if (material.base_color_texture) reading.warn(node["material"].place, "a texture on an optic is ignored");
}

void warn_count(std::size_t count, const std::string& what, const std::string& place, Reading& reading) {
    if (count > 0) reading.warn(place, std::to_string(count) + " " + what);
}

void check_far_points(const Node& node, const Cage& cage) {
    const std::optional<std::size_t> far = find_far_point(cage);
    if (!far) return;
    const std::string message = "lies more than " + describe(kFarthestPoint) +
                                " times as far from the middle of the cage as half of its points do";
    if (node.has("points")) node["points"][*far].fail(message);
    node["file"].fail("point " + std::to_string(*far + 1) + " of the file " + message);
}

/// The uv that the material's normal map lies by, where it has one.
void read_optic_uvs(const Node& node, const PolygonMesh& polygons, Mesh& mesh, Reading& reading) {
    const PlacedTexture& map = reading.scene.materials[mesh.material].normal_texture;
    if (!map.picture) return;
    const bool is_second = map.sampler.uv_set == 1 && !polygons.second_uvs.empty();
    mesh.cage_uvs = is_second ? polygons.second_uvs : polygons.uvs;
    mesh.maps_normals = !mesh.cage_uvs.empty();
    if (!mesh.maps_normals) reading.warn(node.place, "has no uv: the normal map of its material is ignored");
}

void read_optic(const Node& node, Mesh& mesh, Reading& reading) {
    if (node.has("shading"))
        node["shading"].fail("is an object's: an optic shows what it reflects and refracts");
    check_optic_material(node, mesh.material, reading);
    if (node.has("primitive")) {
        if (node.has("fit")) node["fit"].fail("an optic's primitive has its own center and size");
        mesh.primitive = read_primitive(node["primitive"], read_transform(node), node);
        mesh.maps_normals = reading.scene.materials[mesh.material].normal_texture.picture != nullptr;
        return;
    }
    if (node.has("patches")) {
        const bool is_glass = reading.scene.materials[mesh.material].transmission_factor == 1;
        read_optic_patches(node, is_glass, mesh, reading);
        read_optic_uvs(node, {}, mesh, reading);
        return;
    }
    PolygonMesh polygons =
        node.has("file") ? read_mesh_file(node, false, reading) : read_inline_polygons(node);
    // Triangle meshes have points once per seam, cages once.
    if (node.has("file") && polygons.is_triangle_soup) weld_points(polygons);
    read_subdivision(node, polygons.cage);
    if (polygons.is_triangle_soup && polygons.cage.scheme == SubdivisionScheme::kCatmullClark)
        join_quads(polygons);
    if (polygons.cage.scheme == SubdivisionScheme::kUnsubdivided) cut_into_triangles(polygons);
    check_scheme(node, polygons.cage);
    place_mesh(polygons, node);
    check_far_points(node, polygons.cage);
    read_optic_uvs(node, polygons, mesh, reading);
    mesh.cage = std::move(polygons.cage);
    if (mesh.cage.scheme == SubdivisionScheme::kUnsubdivided) mesh.cage.normals = std::move(polygons.normals);
    mesh.face_count = mesh.cage.face_vertex_counts.size();

    const CageDiagnostics doubts = diagnose_cage(mesh.cage);
    const bool glass = reading.scene.materials[mesh.material].transmission_factor == 1;
    warn_count(doubts.non_manifold_edges,
               "edges are not manifold: more than two faces meet there, or their windings disagree",
               node.place, reading);
    if (glass)
        warn_count(doubts.boundary_edges,
                   "edges have one face only: this glass is one interface, or a body with holes", node.place,
                   reading);
    warn_count(doubts.repeated_corners, "faces visit a point twice", node.place, reading);
    warn_count(doubts.unknown_creases, "creases lie where there is no edge", node.place, reading);
    warn_count(doubts.flat_faces, "faces have no area", node.place, reading);
}

/// Moves a file's own materials into the scene, and gives every triangle a material of the scene.
void settle_materials(std::vector<Material>& own, Mesh& mesh, Scene& scene) {
    const auto first = static_cast<Id>(scene.materials.size());
    for (Material& material : own) {
        material.name = mesh.name + "/" + material.name;
        scene.materials.push_back(std::move(material));
    }
    std::vector<Id>& materials = mesh.object.material;
    if (mesh.material == kNone && std::find(materials.begin(), materials.end(), kNone) != materials.end()) {
        scene.materials.emplace_back();
        scene.materials.back().name = mesh.name + "/default";
    }
    const Id fallback = mesh.material != kNone ? mesh.material : static_cast<Id>(scene.materials.size() - 1);
    for (Id& material : materials)
        material = mesh.material != kNone || material == kNone ? fallback : first + material;
}

bool asks_for_second_uvs(const Material& material) {
    const TextureSampler* samplers[] = {&material.base_color_sampler,
                                        &material.metallic_roughness_texture.sampler,
                                        &material.normal_texture.sampler, &material.occlusion_texture.sampler,
                                        &material.emissive_texture.sampler};
    return std::any_of(std::begin(samplers), std::end(samplers),
                       [](const TextureSampler* sampler) { return sampler->uv_set == 1; });
}

/// Leaves the second set of uv where a material asks for it; where there is none the first stands in.
void settle_second_uvs(const Node& node, ObjectMesh& object, Reading& reading) {
    const bool is_asked = std::any_of(object.material.begin(), object.material.end(), [&](Id material) {
        return asks_for_second_uvs(reading.scene.materials[material]);
    });
    if (!is_asked) object.second_uvs.clear();
    if (!is_asked || !object.second_uvs.empty()) return;
    reading.warn(node.place,
                 "a texture asks for a second set of uv, of which there is none: the first is taken");
    object.second_uvs = object.uvs;
}

}  // namespace

ObjectShading read_shading(const Node& node) {
    return *find_named<ObjectShading>(
        string_or(node, "shading", std::string(name_of(ObjectShading::kGivenNormals))));
}

namespace {

/// In the world, with the normals that they are lit by.
PolygonMesh read_object_polygons(const Node& node, Mesh& mesh, Reading& reading) {
    if (node.has("patches")) {
        PolygonMesh polygons = read_object_patches(node, mesh);
        set_shading(polygons, read_shading(node));
        return polygons;
    }
    PolygonMesh polygons = node.has("file")        ? read_mesh_file(node, inherits(node), reading)
                           : node.has("primitive") ? read_object_primitive(node["primitive"])
                                                   : read_inline_polygons(node);
    read_subdivision(node, polygons.cage);
    place_mesh(polygons, node);
    set_shading(polygons, read_shading(node));
    return polygons;
}

void read_object(const Node& node, Mesh& mesh, Reading& reading) {
    if (mesh.material != kNone) {
        const Material& material = reading.scene.materials[mesh.material];
        const bool is_mirror = material.metallic_factor == 1 && material.is_matt();
        if (is_mirror || material.transmission_factor == 1)
            reading.warn(
                node["material"].place,
                "a mirror or glass on an object is drawn as a plain surface: an optic reflects and refracts");
    }
    std::vector<Material> own;
    std::size_t uncovered_faces = 0;
    if (node.has("heights")) {
        read_terrain(node, mesh, reading);
    } else {
        PolygonMesh polygons = read_object_polygons(node, mesh, reading);
        if (!mesh.of_patches) mesh.face_count = polygons.cage.face_vertex_counts.size();
        TriangulatedMesh triangulated = triangulate(polygons);
        mesh.object = std::move(triangulated.object);
        uncovered_faces = triangulated.uncovered_faces;
        own = std::move(polygons.materials);
    }
    settle_materials(own, mesh, reading.scene);
    settle_second_uvs(node, mesh.object, reading);
    const AlphaCut cut = cut_by_alpha(mesh.object, reading.scene.materials);
    warn_count(cut.too_fine, "triangles are not cut out by their picture, which has too many texels there",
               node.place, reading);
    warn_count(uncovered_faces, "faces cross themselves: they are drawn as fans from their first corners",
               node.place, reading);
    warn_count(count_without_area(mesh.object), "triangles have no area", node.place, reading);
}

}  // namespace

Mesh read_mesh(const Node& node, std::size_t index, Reading& reading) {
    Mesh mesh;
    mesh.name = "mesh" + std::to_string(index);
    read_fields(node, mesh_fields(), mesh);
    inherits(node);
    mesh.material = find_material(node, reading);
    if (node.has("normals")) read_fields(node["normals"], normal_fields(), mesh.normals);
    mesh.role == Role::kOptic ? read_optic(node, mesh, reading) : read_object(node, mesh, reading);
    return mesh;
}

}  // namespace trilens
