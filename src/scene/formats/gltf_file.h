// Opening glTF and GLB files, and numbers out of their buffers, with every bound checked.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "base/math/vec.h"

namespace tinygltf {

class Model;
}  // namespace tinygltf

namespace trilens {

/// The file with its buffers loaded and its pictures as encoded bytes; nothing in it is checked yet.
/// Throws InputError(file) where it cannot be read at all, and for glTF 1.0.
tinygltf::Model load_gltf_model(const std::string& file);

/// A relative URI as a path: %20 becomes a space, and so on.
std::string decode_gltf_uri(const std::string& uri);

}  // namespace trilens

// Numbers out of a glTF's buffers, with every bound checked.

namespace tinygltf {
class Model;
}

namespace trilens {

/// The accessor's entries one after the other, `components` numbers each; normalised integers become 0..1 or
/// -1..1; sparse ones are filled in. Throws InputError(file, "/accessors/n") where the accessor does not
/// exist, has another number of components, reaches beyond its buffer, or holds a number that is not finite
/// or beyond 1e30.
std::vector<double> read_gltf_accessor(const tinygltf::Model& model, int accessor, int components,
                                       const std::string& file);

/// The same as vectors: Vec2, Vec3 or Vec4.
template <typename Vector>
std::vector<Vector> read_gltf_vectors(const tinygltf::Model& model, int accessor, const std::string& file) {
    const std::vector<double> numbers = read_gltf_accessor(model, accessor, Vector::length(), file);
    const std::size_t width = Vector::length();
    std::vector<Vector> vectors(numbers.size() / width);
    for (std::size_t i = 0; i < numbers.size(); ++i)
        vectors[i / width][static_cast<int>(i % width)] = numbers[i];
    return vectors;
}

}  // namespace trilens
