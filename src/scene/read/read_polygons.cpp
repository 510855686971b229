// Inline cages and subdivision tags out of checked JSON: lengths and indices.
#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "base/files/files.h"
#include "base/util/check.h"
#include "scene/formats/gltf.h"
#include "scene/formats/obj.h"
#include "scene/read/reading.h"

namespace trilens {
namespace {

std::vector<int> read_ints(const Node& node) {
    return node.json.get<std::vector<int>>();
}

/// Indices below `count` of `what`.
std::vector<int> read_indices(const Node& node, std::size_t count, const char* what) {
    std::vector<int> indices = read_ints(node);
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (static_cast<std::size_t>(indices[i]) >= count)
            node[i].fail("index " + std::to_string(indices[i]) + " is out of range: there are " +
                         std::to_string(count) + " " + what);
    return indices;
}

void check_length(const Node& node, long long expected, const std::string& reason) {
    if (static_cast<long long>(node.size()) != expected)
        node.fail("has " + std::to_string(node.size()) + (node.size() == 1 ? " entry" : " entries") +
                  ", must have " + std::to_string(expected) + ": " + reason);
}

void read_uvs(const Node& mesh, PolygonMesh& polygons) {
    const std::size_t corners = polygons.cage.face_vertex_indices.size();
    const Node node = mesh["uvs"];
    std::vector<Vec2> uvs;
    for (const Json& uv : node.json) uvs.push_back(to_vec2(uv));
    if (!mesh.has("uvIndices")) {
        check_length(node, static_cast<long long>(corners),
                     "without uvIndices one per entry of faceVertexIndices");
        polygons.uvs = std::move(uvs);
        return;
    }
    const Node indices = mesh["uvIndices"];
    check_length(indices, static_cast<long long>(corners), "one per entry of faceVertexIndices");
    for (const int index : read_indices(indices, uvs.size(), "uvs"))
        polygons.uvs.push_back(uvs[static_cast<std::size_t>(index)]);
}

/// One per point, given to the corners.
void read_colors(const Node& node, PolygonMesh& polygons) {
    check_length(node, static_cast<long long>(polygons.cage.points.size()), "one per entry of points");
    for (const int point : polygons.cage.face_vertex_indices) {
        const auto color = node.json.at(static_cast<std::size_t>(point)).get<std::vector<double>>();
        polygons.colors.emplace_back(color[0], color[1], color[2], color.size() > 3 ? color[3] : 1);
    }
}

void read_creases(const Node& mesh, Cage& cage) {
    const Node indices = mesh["creaseIndices"], sharpnesses = mesh["creaseSharpnesses"];
    cage.crease_indices = read_indices(indices, cage.points.size(), "points");
    const auto count = static_cast<long long>(cage.crease_indices.size());
    if (mesh.has("creaseLengths")) {
        const Node lengths = mesh["creaseLengths"];
        cage.crease_lengths = read_ints(lengths);
        const long long sum = std::accumulate(cage.crease_lengths.begin(), cage.crease_lengths.end(), 0LL);
        if (sum != count)
            lengths.fail("the lengths sum to " + std::to_string(sum) + ", but creaseIndices has " +
                         std::to_string(count) + " entries");
    } else {
        if (count % 2 != 0)
            indices.fail("without creaseLengths the points go in pairs, but there are " +
                         std::to_string(count));
        cage.crease_lengths.assign(static_cast<std::size_t>(count / 2), 2);
    }
    cage.crease_sharpnesses = sharpnesses.json.get<std::vector<double>>();
    const auto chains = static_cast<long long>(cage.crease_lengths.size()), edges = count - chains;
    if (static_cast<long long>(sharpnesses.size()) != edges)
        check_length(sharpnesses, chains, "one per chain, or one per edge (" + std::to_string(edges) + ")");
}

}  // namespace

PolygonMesh read_inline_polygons(const Node& mesh) {
    PolygonMesh polygons;
    Cage& cage = polygons.cage;
    for (const Json& point : mesh["points"].json) cage.points.push_back(to_vec3(point));
    cage.face_vertex_counts = read_ints(mesh["faceVertexCounts"]);
    const Node indices = mesh["faceVertexIndices"];
    cage.face_vertex_indices = read_indices(indices, cage.points.size(), "points");
    check_length(indices,
                 std::accumulate(cage.face_vertex_counts.begin(), cage.face_vertex_counts.end(), 0LL),
                 "the sum of faceVertexCounts");
    if (mesh.has("uvs")) read_uvs(mesh, polygons);
    if (mesh.has("colors")) read_colors(mesh["colors"], polygons);
    if (mesh.has("uvs1")) {
        check_length(mesh["uvs1"], static_cast<long long>(polygons.cage.face_vertex_indices.size()),
                     "one per entry of faceVertexIndices");
        for (const Json& uv : mesh["uvs1"].json) polygons.second_uvs.push_back(to_vec2(uv));
    }
    return polygons;
}

const std::vector<Field<Cage>>& subdivision_fields() {
    static const std::vector<Field<Cage>> fields{
        choice("subdivisionScheme", &Cage::scheme),
        choice("interpolateBoundary", &Cage::interpolate_boundary),
        part<Cage>("creaseIndices", list_of(ref("index")), "Chains of points, one after the other."),
        part<Cage>("creaseLengths", list_of(whole_in(2, kMostIndex)), "Points per chain; absent: pairs."),
        part<Cage>("creaseSharpnesses", list_of(ref("notNegative")),
                   "One per chain, or one per edge; 10 and more is infinite."),
        part<Cage>("cornerIndices", list_of(ref("index"))),
        part<Cage>("cornerSharpnesses", list_of(ref("notNegative"))),
        part<Cage>("holeIndices", list_of(ref("index")), "Faces that are not drawn."),
    };
    return fields;
}

void read_subdivision(const Node& mesh, Cage& cage) {
    read_fields(mesh, subdivision_fields(), cage);
    if (mesh.has("creaseIndices")) read_creases(mesh, cage);
    if (mesh.has("cornerIndices")) {
        cage.corner_indices = read_indices(mesh["cornerIndices"], cage.points.size(), "points");
        check_length(mesh["cornerSharpnesses"], static_cast<long long>(cage.corner_indices.size()),
                     "one per entry of cornerIndices");
        cage.corner_sharpnesses = mesh["cornerSharpnesses"].json.get<std::vector<double>>();
    }
    if (mesh.has("holeIndices"))
        cage.hole_indices = read_indices(mesh["holeIndices"], cage.face_vertex_counts.size(), "faces");
}

void check_scheme(const Node& mesh, const Cage& cage) {
    if (cage.scheme != SubdivisionScheme::kLoop) return;
    for (std::size_t face = 0; face < cage.face_vertex_counts.size(); ++face)
        if (cage.face_vertex_counts[face] != 3)
            mesh["subdivisionScheme"].fail("loop needs triangles, but face " + std::to_string(face) +
                                           " has " + std::to_string(cage.face_vertex_counts[face]) +
                                           " corners");
}

// The polygons and materials of the file that a mesh names.

namespace {

/// The materials of an OBJ's libraries by name. A library that is missing is a warning, as most viewers have
/// it.
std::map<std::string, MtlMaterial> read_libraries(const ObjFile& obj, const std::filesystem::path& folder,
                                                  const std::string& place, Reading& reading) {
    std::map<std::string, MtlMaterial> by_name;
    for (const std::string& library : obj.material_libraries) {
        const std::string path = (folder / library).string();
        if (!std::filesystem::exists(path) || std::filesystem::is_directory(path)) {
            reading.warn(place, "the material library '" + path + "' " +
                                    (std::filesystem::exists(path) ? "is a folder" : "does not exist"));
            continue;
        }
        const MtlFile mtl = parse_mtl(reading.read_file(path), path);
        for (const std::string& warning : mtl.warnings) reading.warn(place, path + ": " + warning);
        for (const MtlMaterial& material : mtl.materials) by_name.emplace(material.name, material);
    }
    return by_name;
}

/// A picture that an MTL names. Throws InputError where it does not exist.
std::string picture_path(const MtlMaterial& mtl, std::string path, const std::filesystem::path& folder) {
    std::replace(path.begin(), path.end(), '\\', '/');
    std::string resolved = (folder / path).string();
    if (!std::filesystem::exists(resolved))
        throw InputError(resolved, "", "the picture of material '" + mtl.name + "' does not exist");
    return resolved;
}

/// Phong's terms in those of metallic-roughness. Source: Walter, Marschner, Li, Torrance, Microfacet Models
/// for Refraction through Rough Surfaces, EGSR 2007: Blinn's exponent is 2 / alpha^2 - 2; alpha is roughness
/// squared.
Material make_material(const MtlMaterial& mtl, const std::filesystem::path& folder, Reading& reading) {
    Material material;
    material.name = mtl.name;
    material.base_color_factor = mtl.diffuse;
    if (mtl.specular != Vec3(0)) {
        material.brdf = Brdf::kMetallicRoughness;
        material.roughness_factor = std::pow(2 / (mtl.exponent + 2), 0.25);
        material.specular_color_factor = mtl.specular;
    }
    if (!mtl.texture.empty())
        material.base_color_texture = read_picture(reading, picture_path(mtl, mtl.texture, folder));
    if (!mtl.bump.empty()) {
        std::shared_ptr<const Texture> map = read_numbers(reading, picture_path(mtl, mtl.bump, folder));
        material.normal_texture.picture = mtl.is_normals ? map : normals_of_heights(*map, {});
        material.normal_scale = mtl.bump_scale;
    }
    return material;
}

/// The heights by which a material moves its faces.
HeightMap make_heights(const MtlMaterial& mtl, const std::filesystem::path& folder, Reading& reading) {
    HeightMap heights{{}, mtl.displacement_gain, mtl.displacement_base};
    if (!mtl.displacement.empty())
        heights.texture.picture = read_numbers(reading, picture_path(mtl, mtl.displacement, folder));
    return heights;
}

/// Turns the OBJ's material names into materials, those that faces use only.
void inherit_materials(ObjFile& obj, const std::filesystem::path& folder, const std::string& place,
                       Reading& reading) {
    const std::map<std::string, MtlMaterial> by_name = read_libraries(obj, folder, place, reading);
    std::vector<Id> index_of_name(obj.material_names.size(), kNone);
    for (std::size_t i = 0; i < obj.material_names.size(); ++i) {
        const auto& used = obj.mesh.face_material;
        if (std::find(used.begin(), used.end(), static_cast<Id>(i)) == used.end()) continue;
        const auto found = by_name.find(obj.material_names[i]);
        if (found == by_name.end()) {
            reading.warn(place, "the material '" + obj.material_names[i] +
                                    "' is in no library: drawn in the default colour");
            continue;
        }
        index_of_name[i] = static_cast<Id>(obj.mesh.materials.size());
        obj.mesh.materials.push_back(make_material(found->second, folder, reading));
        obj.mesh.heights.push_back(make_heights(found->second, folder, reading));
    }
    for (Id& material : obj.mesh.face_material)
        if (material != kNone) material = index_of_name[material];
}

PolygonMesh read_obj_file(const std::string& path, bool inherit, const std::string& place, Reading& reading) {
    ObjFile obj = parse_obj(reading.read_file(path), path);
    for (const std::string& warning : obj.warnings) reading.warn(place, path + ": " + warning);
    if (inherit)
        inherit_materials(obj, std::filesystem::path(path).parent_path(), place, reading);
    else
        obj.mesh.face_material.clear();
    return std::move(obj.mesh);
}

/// What of the file the mesh asks for.
GltfPart part_of(const Node& mesh, const GltfModel& model) {
    const auto index = [&](const char* key, std::size_t count, const char* what) {
        if (!mesh.has(key)) return -1;
        const int number = mesh.json.at(key).get<int>();
        if (static_cast<std::size_t>(number) >= count)
            mesh[key].fail(std::string(what) + " " + std::to_string(number) + " is out of range: there are " +
                           std::to_string(count));
        return number;
    };
    GltfPart part;
    part.node = index("node", model.nodes.size(), "node");
    part.moment.animation = index("clip", model.animations.size(), "animation");
    part.moment.time = number_or(mesh, "time", 0);
    if (part.node < 0) return part;
    const int shape = model.nodes[static_cast<std::size_t>(part.node)].mesh;
    if (shape < 0) mesh["node"].fail("node " + std::to_string(part.node) + " has no mesh");
    if (mesh.has("parts"))
        part.parts = read_indices(
            mesh["parts"], model.meshes[static_cast<std::size_t>(shape)].primitives.size(), "primitives");
    return part;
}

PolygonMesh read_gltf_file(const Node& mesh, const std::string& path, bool inherit, Reading& reading) {
    const GltfModel& model = read_gltf_once(reading, path);
    const std::string place = mesh["file"].place;
    if (!mesh.has("node")) {
        const auto ignore = [&](bool any, const char* what) {
            if (any) reading.warn(place, path + ": " + what);
        };
        ignore(!model.cameras.empty(), "cameras are ignored: the scene names its own");
        ignore(!model.lights.empty(), "lights are ignored: the scene names its own");
        ignore(!model.animations.empty() && !mesh.has("clip"), "animations are ignored");
    }
    if (inherit)
        for (const std::string& warning : model.material_warnings) reading.warn(place, path + ": " + warning);
    return polygons_of_gltf(model, path, inherit ? &reading.textures : nullptr, part_of(mesh, model));
}

}  // namespace

const GltfModel& read_gltf_once(Reading& reading, const std::string& path) {
    std::shared_ptr<const GltfModel>& model = reading.gltf_of_path[path];
    if (model) return *model;
    reading.note_file(path);
    model = std::make_shared<const GltfModel>(read_gltf(path));
    for (const std::string& buffer : model->buffer_files) reading.note_file(buffer);
    for (const std::string& warning : model->warnings)
        reading.scene.warnings.push_back(path + ": " + one_line(warning));
    return *model;
}

std::shared_ptr<const Texture> read_gltf_picture(Reading& reading, const Node& file, const Node& image) {
    const std::string path = reading.resolve(file.json.get<std::string>());
    const auto number = image.json.get<std::size_t>();
    const GltfImage* picture = nullptr;
    try {
        const GltfModel& model = read_gltf_once(reading, path);
        if (number < model.images.size()) picture = &model.images[number];
    } catch (const InputError& error) {
        file.fail(error.what());
    }
    if (!picture) image.fail("the glTF has no picture of that number");
    if (picture->file.empty() && picture->encoded.empty()) image.fail("the picture holds no data");
    std::shared_ptr<const Texture>& texture = reading.texture_of_path[picture->name];
    TRILENS_CHECK(reading.textures.from_memory, "a scene with pictures needs a texture reader");
    try {
        if (!texture)
            texture = picture->file.empty() ? reading.textures.from_memory(picture->encoded, picture->name)
                                            : read_picture(reading, picture->file);
    } catch (const InputError& error) {
        image.fail(error.what());
    }
    return texture;
}

PolygonMesh read_mesh_file(const Node& mesh, bool inherit, Reading& reading) {
    const Node node = mesh["file"];
    const std::string path = reading.resolve(node.json.get<std::string>());
    const std::string extension = file_ending(path);
    const bool is_gltf = extension == ".gltf" || extension == ".glb";
    if (extension.rfind(".usd", 0) == 0)
        node.fail("'" + path + "' is USD, which is not read: export glTF (.glb) or OBJ instead");
    if (!is_gltf && extension != ".obj")
        node.fail("'" + path + "' is of no known kind: known are .obj, .gltf and .glb");
    for (const char* key : {"node", "clip"})
        if (!is_gltf && mesh.has(key)) mesh[key].fail("is of a glTF, which '" + path + "' is not");
    try {
        return is_gltf ? read_gltf_file(mesh, path, inherit, reading)
                       : read_obj_file(path, inherit, node.place, reading);
    } catch (const InputError& error) {
        node.fail(error.what());
    }
}

}  // namespace trilens
