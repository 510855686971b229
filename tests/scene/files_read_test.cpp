// A scene lists every file that it was made of, with the hash of what stood there.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>

#include "base/description/digest.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Three corners, three indices (uint16), padded.
std::string triangle_buffer() {
    const float corners[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    const std::uint16_t indices[4] = {0, 1, 2, 0};
    std::string bytes(sizeof corners + sizeof indices, '\0');
    std::memcpy(bytes.data(), corners, sizeof corners);
    std::memcpy(bytes.data() + sizeof corners, indices, sizeof indices);
    return bytes;
}

const char* kReadGltf = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
  "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],
  "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
  "images":[{"uri":"leaf%20green.png"}],
  "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
               {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}],
  "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":6}],
  "buffers":[{"uri":"my%20tree.bin","byteLength":44}]})";

const char* kScene = R"({"version":1,"cameras":[{"lookAt":{"eye":[0,0,4],"at":[0,0,0]}}],
  "background":{"file":"sky.exr"},
  "materials":[{"name":"paint","baseColorTexture":"paint.png"},{"name":"chrome","metallicFactor":1}],
  "meshes":[{"role":"object","file":"parts/chair.obj"},{"role":"object","file":"parts/tree.gltf"},
            {"role":"object","material":"paint","file":"parts/chair.obj"},
            {"role":"optic","material":"chrome","file":"bowl.obj"}]})";

/// Writes the scene with all it names; what each file holds, by its path.
std::map<std::string, std::string> write_files(const std::string& folder) {
    const std::string quad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
    const std::map<std::string, std::string> files = {
        {"room.json", kScene},
        {"sky.exr", "a sky"},
        {"paint.png", "a paint"},
        {"parts/chair.obj", "mtllib chair.mtl\nmtllib missing.mtl\nusemtl wood\n" + quad},
        {"parts/chair.mtl", "newmtl wood\nmap_Kd wood.png\nnewmtl unused\nmap_Kd unused.png\n"},
        {"parts/wood.png", "wood"},
        {"parts/tree.gltf", kReadGltf},
        {"parts/my tree.bin", triangle_buffer()},
        {"parts/leaf green.png", "leaves"},
        {"bowl.obj", quad}};
    std::filesystem::create_directory(folder + "/parts");
    std::map<std::string, std::string> by_path;
    for (const auto& [name, bytes] : files) {
        by_path[folder + "/" + name] = bytes;
        std::ofstream(folder + "/" + name, std::ios::binary) << bytes;
    }
    return by_path;
}

std::map<std::string, std::string> hash_of_path(const Scene& scene) {
    std::map<std::string, std::string> hashes;
    for (const FileRead& file : scene.files) {
        INFO(file.path);
        CHECK(hashes.emplace(file.path, file.hash).second);
    }
    return hashes;
}

}  // namespace

TEST_CASE("every kind of file that a scene reads is listed once with the hash of its bytes", "[scene]") {
    const std::string folder = scratch_dir("scene_files_read");
    std::map<std::string, std::string> wanted = write_files(folder);
    for (auto& [path, bytes] : wanted) bytes = hash_text(bytes);
    const std::string file = folder + "/room.json";
    const Scene scene = load_scene(file, {}, white_textures());
    REQUIRE(!scene.files.empty());
    CHECK(scene.files.front().path == file);
    CHECK(hash_of_path(scene) == wanted);

    // From text the scene file itself was not read.
    wanted.erase(file);
    CHECK(hash_of_path(load_text(kScene, {}, file)) == wanted);

    // One that changes is told apart, all others stay.
    std::ofstream(folder + "/parts/wood.png") << "oak";
    wanted[folder + "/parts/wood.png"] = hash_text("oak");
    CHECK(hash_of_path(load_text(kScene, {}, file)) == wanted);
}

TEST_CASE("a scene in the current folder lists absolute paths", "[scene]") {
    const std::string folder = scratch_dir("scene_files_here");
    write_files(folder);
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder);
    const Scene scene = load_scene("room.json", {}, white_textures());
    std::filesystem::current_path(before);
    CHECK(scene.files.size() == 10);
    for (const FileRead& file : scene.files) {
        CHECK(std::filesystem::path(file.path).is_absolute());
        CHECK(std::filesystem::exists(file.path));
    }
}

TEST_CASE("a scene of one text reads no file", "[scene]") {
    CHECK(load_text(kRoom).files.empty());
}
