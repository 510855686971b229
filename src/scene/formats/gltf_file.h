// Opening glTF and GLB files.
#pragma once

#include <string>

namespace tinygltf {
class Model;
}

namespace trilens {

/// The file with its buffers loaded and its pictures as encoded bytes; nothing in it is checked yet.
/// Throws InputError(file) where it cannot be read at all, and for glTF 1.0.
tinygltf::Model load_gltf_model(const std::string& file);

/// A relative URI as a path: %20 becomes a space, and so on.
std::string decode_gltf_uri(const std::string& uri);

}  // namespace trilens
