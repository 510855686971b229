// Extensions of glTF: which are known, and instances of a node's mesh (EXT_mesh_gpu_instancing) as nodes of
// their own.
#include <algorithm>
#include <optional>
#include <set>
#include <string>

#include <tiny_gltf.h>

#include "scene/formats/gltf_file.h"
#include "scene/formats/gltf_parts.h"

namespace trilens {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

/// Where the instances stand within their node: as many entries of each kind, or none of it.
struct InstancePlaces {
    std::size_t count = 0;
    std::vector<Vec3> translations, scales;
    std::vector<Vec4> rotations;
};

/// None where the node has no instances, or none that an attribute of the three places. The keys' types are
/// checked.
std::optional<InstancePlaces> read_places(const GltfSource& source, std::size_t node,
                                          const std::string& place) {
    const tinygltf::ExtensionMap& all = source.model.nodes[node].extensions;
    const auto found = all.find(kInstancing);
    if (found == all.end()) return std::nullopt;
    const Json attributes = json_of_gltf(found->second).value("attributes", Json::object());
    InstancePlaces places;
    const auto read = [&](const char* name, auto& into) {
        if (!attributes.contains(name)) return;
        using Vector = typename std::decay_t<decltype(into)>::value_type;
        into = read_gltf_vectors<Vector>(source.model, attributes.at(name).get<int>(), source.file);
        if (places.count > 0 && places.count != into.size())
            source.fail(place, "its attributes have " + std::to_string(places.count) + " entries and " +
                                   std::to_string(into.size()));
        places.count = into.size();
    };
    read("TRANSLATION", places.translations);
    read("ROTATION", places.rotations);
    read("SCALE", places.scales);
    return places.count > 0 ? std::optional(std::move(places)) : std::nullopt;
}

/// Whether bones or morph targets move it within its node.
bool is_posed(const GltfModel& model, const GltfNode& node) {
    const std::vector<GltfPrimitive>& all = model.meshes[static_cast<std::size_t>(node.mesh)].primitives;
    return node.skin >= 0 || std::any_of(all.begin(), all.end(), [](const GltfPrimitive& primitive) {
               return !primitive.targets.empty();
           });
}

}  // namespace

void check_gltf_extensions(GltfSource& source) {
    static const std::set<std::string> known = {"KHR_materials_unlit",
                                                "KHR_mesh_quantization",
                                                "KHR_texture_transform",
                                                "KHR_lights_punctual",
                                                "KHR_materials_ior",
                                                "KHR_materials_transmission",
                                                "KHR_materials_volume",
                                                "KHR_materials_specular",
                                                "KHR_materials_dispersion",
                                                "EXT_texture_webp",
                                                kInstancing,
                                                "KHR_materials_emissive_strength"};
    for (const std::string& name : source.model.extensionsRequired)
        if (known.count(name) == 0)
            source.fail("/extensionsRequired", "the extension '" + name + "' is required but not supported");
    for (const std::string& name : source.model.extensionsUsed)
        if (known.count(name) == 0) source.warn("the extension '" + name + "' is ignored");
}

void read_gltf_instances(GltfSource& source, GltfModel& into) {
    const std::size_t count = into.nodes.size();
    for (std::size_t i = 0; i < count; ++i) {
        const std::string place = "/nodes/" + std::to_string(i) + "/extensions/" + kInstancing;
        const std::optional<InstancePlaces> places = read_places(source, i, place);
        if (!places || into.nodes[i].mesh < 0) continue;
        if (is_posed(into, into.nodes[i])) {
            source.warn("instances of a mesh with a skin or morph targets are one");
            continue;
        }
        // What all have in common, in the node's frame.
        GltfNode instance;
        instance.name = into.nodes[i].name;
        instance.mesh = into.nodes[i].mesh;
        instance.extras = into.nodes[i].extras;
        into.nodes[i].mesh = -1;
        for (std::size_t k = 0; k < places->count; ++k) {
            if (!places->translations.empty()) instance.translation = places->translations[k];
            if (!places->rotations.empty()) instance.rotation = places->rotations[k];
            if (!places->scales.empty()) instance.scale = places->scales[k];
            if (instance.rotation == Vec4(0)) source.fail(place, "a rotation must not be zero");
            into.nodes[i].children.push_back(static_cast<int>(into.nodes.size()));
            into.nodes.push_back(instance);
        }
    }
}

}  // namespace trilens
