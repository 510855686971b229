// What tests of glTF scenes share: a small glTF to change, and what loading it ends in.
#pragma once

#include <cmath>
#include <cstring>
#include <fstream>
#include <string>
#include <vector>

#include "scene_text.h"

namespace trilens_test {

using namespace trilens;

/// Numbers of a glTF's buffer, and the accessors that name them.
struct GltfBuffer {
    std::string bytes, views, accessors;
    int count = 0;

    int add(const std::vector<double>& numbers, const std::string& type, int width, int component = 5126) {
        const std::size_t start = bytes.size();
        for (const double number : numbers) {
            if (component == 5126) {
                const auto real = static_cast<float>(number);
                bytes.append(reinterpret_cast<const char*>(&real), sizeof real);
            } else {
                const auto whole = static_cast<std::uint16_t>(number);
                bytes.append(reinterpret_cast<const char*>(&whole), sizeof whole);
            }
        }
        const std::string comma = count == 0 ? "" : ",";
        views += comma + R"({"buffer":0,"byteOffset":)" + std::to_string(start) + R"(,"byteLength":)" +
                 std::to_string(bytes.size() - start) + "}";
        accessors += comma + R"({"bufferView":)" + std::to_string(count) + R"(,"componentType":)" +
                     std::to_string(component) + R"(,"count":)" +
                     std::to_string(numbers.size() / static_cast<std::size_t>(width)) + R"(,"type":")" +
                     type + "\"}";
        while (bytes.size() % 4 != 0) bytes += '\0';
        return count++;
    }
};

/// A unit square (0), its indices (1), a morph target's steps (2), joints (3) and weights (4) of two bones,
/// their inverse bind matrices (5), times 0 and 2 (6), translations (7), weights of the target (8), a cubic
/// spline of translations (9), rotations of a quarter turn (10).
inline GltfBuffer make_buffer() {
    GltfBuffer buffer;
    buffer.add({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3", 3);
    buffer.add({0, 1, 2, 2, 1, 3}, "SCALAR", 1, 5123);
    buffer.add({0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 0, 2}, "VEC3", 3);
    buffer.add({0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 4, 5123);
    buffer.add({1, 0, 0, 0, 1, 0, 0, 0, 0.5, 0.5, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
    buffer.add(
        {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1},
        "MAT4", 16);
    buffer.add({0, 2}, "SCALAR", 1);
    buffer.add({0, 0, 0, 4, 0, 0}, "VEC3", 3);
    buffer.add({0, 1}, "SCALAR", 1);
    buffer.add({0, 0, 0, 0, 0, 0, 3, 0, 0, -3, 0, 0, 1, 0, 0, 0, 0, 0}, "VEC3", 3);
    buffer.add({0, 0, 0, 1, 0, 0, std::sqrt(0.5), std::sqrt(0.5)}, "VEC4", 4);
    return buffer;
}

/// The parts of a glTF that a test may say otherwise.
struct GltfParts {
    std::string nodes = R"([{"name":"square","mesh":0}])", roots = "[0]";
    std::string primitive = R"({"attributes":{"POSITION":0},"indices":1,"material":0})";
    std::string materials = R"([{"name":"paint","pbrMetallicRoughness":{"metallicFactor":0}}])";
    std::string more;  // top-level members, each after a comma
};

inline std::string write_gltf(const std::string& folder, const GltfParts& parts,
                              const GltfBuffer& buffer = make_buffer()) {
    std::ofstream(folder + "/room.bin", std::ios::binary) << buffer.bytes;
    std::ofstream(folder + "/room.gltf")
        << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":)" + parts.roots + R"(}],"nodes":)" +
               parts.nodes + R"(,"meshes":[{"name":"shape","primitives":[)" + parts.primitive +
               R"(]}],"materials":)" + parts.materials + R"(,"accessors":[)" + buffer.accessors +
               R"(],"bufferViews":[)" + buffer.views + R"(],"buffers":[{"uri":"room.bin","byteLength":)" +
               std::to_string(buffer.bytes.size()) + "}]" + parts.more + "}";
    return folder + "/room.gltf";
}

inline Scene load(const std::string& file, const ImportOptions& import = {},
                  const std::vector<SceneOverride>& overrides = {}) {
    return load_scene(file, overrides, white_textures(), import);
}

/// What follows the file's name in the message.
inline std::string load_error(const std::string& file, const ImportOptions& import = {}) {
    try {
        load(file, import);
        return "";
    } catch (const InputError& error) {
        REQUIRE(begins_with(error.what(), file));
        return std::string(error.what()).substr(file.size());
    }
}

inline bool warns(const Scene& scene, const std::string& part) {
    for (const std::string& warning : scene.warnings)
        if (contains(warning, part)) return true;
    return false;
}

}  // namespace trilens_test
