// The polygons and materials of the file that a mesh names.
#include <algorithm>
#include <cctype>
#include <map>
#include <set>

#include "scene/formats/gltf.h"
#include "scene/formats/obj.h"
#include "scene/read/reading.h"

namespace trilens {
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

Material make_material(const MtlMaterial& mtl, const std::filesystem::path& folder, Reading& reading) {
    Material material;
    material.name = mtl.name;
    material.base_color_factor = mtl.diffuse;
    if (mtl.texture.empty()) return material;
    std::string path = mtl.texture;
    std::replace(path.begin(), path.end(), '\\', '/');
    const std::string resolved = (folder / path).string();
    if (!std::filesystem::exists(resolved))
        throw InputError(resolved, "", "the picture of material '" + mtl.name + "' does not exist");
    material.base_color_texture = read_picture(reading, resolved);
    return material;
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

PolygonMesh read_gltf_file(const std::string& path, bool inherit, const std::string& place,
                           Reading& reading) {
    reading.note_file(path);
    const GltfModel model = read_gltf(path);
    for (const std::string& buffer : model.buffer_files) reading.note_file(buffer);
    for (const std::string& warning : model.warnings) reading.warn(place, path + ": " + warning);
    if (inherit)
        for (const std::string& warning : model.material_warnings) reading.warn(place, path + ": " + warning);
    return polygons_of_gltf(model, path, inherit ? &reading.textures : nullptr);
}

}  // namespace

PolygonMesh read_mesh_file(const Node& mesh, bool inherit, Reading& reading) {
    const Node node = mesh["file"];
    const std::string path = reading.resolve(node.json.get<std::string>());
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& letter : extension)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    const bool is_gltf = extension == ".gltf" || extension == ".glb";
    if (!is_gltf && extension != ".obj")
        node.fail("'" + path + "' is of no known kind: known are .obj, .gltf and .glb");
    if (is_gltf && mesh["role"].json == "optic")
        node.fail(
            "a glTF file holds triangles only, and so cannot hold the cage of an optic: give an OBJ of "
            "quads");
    try {
        return is_gltf ? read_gltf_file(path, inherit, node.place, reading)
                       : read_obj_file(path, inherit, node.place, reading);
    } catch (const InputError& error) {
        node.fail(error.what());
    }
}

}  // namespace trilens
