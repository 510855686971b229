// The settings of meshes: what they are, how optics are cut into facets, and the keys of their shapes.
#include <utility>
#include <vector>

#include "base/util/names.h"
#include "scene/meshes/vertex_normals.h"
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

/// Read with the file.
Field<Mesh> vertex_colors_field() {
    Json schema = yes_or_no();
    schema["default"] = true;
    return part<Mesh>("vertexColors", std::move(schema),
                      "object: whether the colours that its file has at its points (glTF's COLOR_0, an OBJ's "
                      "after the coordinates) are factors of its material's base colour.");
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
        part<Mesh>("colors", list_of(ref("vertexColor"), 1),
                   "object: one per point, linear, with or without alpha: factors of the material's base "
                   "colour, as glTF's COLOR_0; straight between the corners of each triangle."),
        vertex_colors_field(),
    };
    add_keys(subdivision_fields(), fields);
    add_keys(terrain_fields(), fields);
    fields.push_back(part<Mesh>("displacement", ref("displacement")));
    fields.push_back(part<Mesh>("normals", ref("normals")));
    fields.push_back(part<Mesh>("bakedLight", ref("bakedLight")));
    return fields;
}

// Which keys go together, whatever they hold.
constexpr const char* kMeshRules = R"json({
  "oneOf": [ { "required": ["points"] }, { "required": ["file"] }, { "required": ["primitive"] }, { "required": ["heights"] }, { "required": ["patches"] } ],
  "dependencies": {
    "heights": ["size"], "size": ["heights"], "noData": ["heights"], "heightError": ["heights"],
    "tolerance": ["heights"],
    "points": ["faceVertexCounts", "faceVertexIndices"], "faceVertexCounts": ["points"], "faceVertexIndices": ["points"],
    "uvIndices": ["uvs"], "creaseIndices": ["creaseSharpnesses"], "creaseSharpnesses": ["creaseIndices"],
    "colors": ["points"], "vertexColors": ["file"], "node": ["file"], "parts": ["node"], "clip": ["file"], "time": ["clip"],
    "creaseLengths": ["creaseIndices"], "cornerIndices": ["cornerSharpnesses"], "cornerSharpnesses": ["cornerIndices"]
  },
  "allOf": [
    { "if": { "required": ["tolerance"] },
      "then": { "title": "a terrain with a tolerance", "properties": { "heightError": false, "fit": false } },
      "else": { "title": "a terrain without a tolerance", "dependencies": { "thinning": ["heightError"], "region": ["heightError"] } } },
    { "if": { "properties": { "role": { "const": "optic" } } },
      "then": { "title": "an optic", "required": ["material"], "properties": { "heights": false, "bakedLight": false } } },
    { "if": { "properties": { "role": { "const": "terrain" } } },
      "then": { "title": "a terrain", "required": ["heights"] } },
    { "if": { "required": ["heights"] },
      "then": { "title": "a terrain", "properties": { "role": { "const": "terrain" }, "displacement": false, "uvs": false, "uvIndices": false, "uvs1": false } } },
    { "if": { "required": ["file"] },
      "then": { "title": "a mesh with a file", "properties": { "uvs": false, "uvIndices": false } } },
    { "if": { "required": ["patches"] },
      "then": { "title": "a mesh of patches", "properties": { "displacement": false, "uvs": false, "uvIndices": false, "uvs1": false, "subdivisionScheme": false, "interpolateBoundary": false,
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

}  // namespace trilens
