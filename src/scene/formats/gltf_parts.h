// What the readers of a glTF's parts share: the library's model, complaints with their places, extensions as
// JSON.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "json/json.h"
#include "scene/formats/gltf.h"

namespace tinygltf {
class Model;
class Value;
}  // namespace tinygltf

namespace trilens {

/// A glTF being read.
struct GltfSource {
    const tinygltf::Model& model;
    const std::string& file;
    std::set<std::string> warned = {}, material_warned = {};

    /// `place`: JSON pointer. Throws InputError.
    [[noreturn]] void fail(const std::string& place, const std::string& message) const;
    void warn(const std::string& message) { warned.insert(message); }
    void warn_of_material(const std::string& message) { material_warned.insert(message); }
    /// The index, which is -1 (none) or below `count`. Throws InputError.
    int checked(int index, std::size_t count, const std::string& place, const char* what) const;
    /// Of morph targets. Throws InputError where one is beyond the range of coordinates.
    void check_weights(const std::vector<double>& weights, const std::string& place) const;
    /// A relative URI as a path from where the program runs; empty for a data URI and for none.
    std::string resolve(const std::string& uri) const;
};

/// Extras and extensions; null where there are none.
Json json_of_gltf(const tinygltf::Value& value);

/// A number of an extension, which must lie in low..high. Throws InputError.
double gltf_number(const GltfSource& source, const Json& number, double low, double high,
                   const std::string& place);

/// Every key that is read: its type, and its range where the other readers do not look at that. An index must
/// be that of an entry. Throws InputError with the key's place.
void check_gltf_keys(const Json& json, const std::string& file);

/// Warns of extensions that are not known. Throws InputError where the file requires one.
void check_gltf_extensions(GltfSource& source);

void read_gltf_meshes(GltfSource& source, GltfModel& into);
void read_gltf_materials(GltfSource& source, GltfModel& into);
/// Cameras and KHR_lights_punctual.
void read_gltf_views(GltfSource& source, GltfModel& into);
/// Instances of nodes' meshes (EXT_mesh_gpu_instancing) become children of their nodes, whose mesh they take;
/// after the meshes and nodes, before the nodes' parents are found.
void read_gltf_instances(GltfSource& source, GltfModel& into);
/// Skins and animations; after the nodes.
void read_gltf_motion(GltfSource& source, GltfModel& into);

}  // namespace trilens
