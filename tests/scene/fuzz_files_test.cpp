// Law: a broken OBJ, MTL, glTF, GLB or buffer loads or fails with a message that names its file.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <random>

#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kObj =
    "# a comment\nmtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.5 0.25 0 1\nvt 0 0\nvt 1 0.5\nvn 0 0 "
    "1\n"
    "usemtl red\nf 1/1/1 2/2/1 3/1/1 4/2/1\ns off\ng some\nusemtl brick\nf 1 5 -1 \\\n -3 4\nl 1 2\n"
    "t crease 2/1/0 0 1 2.5\nt corner 1/1/0 3 4\nt hole 1/0/0 1\nt interpolateboundary 1/0/0 2\n";
const std::string kMtl =
    "newmtl red\nNs 225\nKa 1 1 1\nKd 0.8 0.1 1e-1\nd 0.5\nillum 2\n\nnewmtl brick\nKd 1 1 1\n"
    "map_Kd -s 1 1 1 -clamp on brick wall.png\nTr 0\nmap_Bump -bm 2 b.png\n";
const std::string kGltf =
    R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"children":[1],"scale":[1,2,1]},
{"mesh":0,"rotation":[0,0,0,1],"translation":[1,2,3]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":2},
"indices":1,"material":0,"mode":4}]}],"materials":[{"name":"m","pbrMetallicRoughness":{"baseColorFactor":[1,0.5,0,1],
"baseColorTexture":{"index":0},"metallicFactor":0}}],"textures":[{"source":0}],"images":[{"uri":"brick.png"}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":3,
"componentType":5123},"values":{"bufferView":4}}},{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"},
{"bufferView":2,"componentType":5123,"normalized":true,"count":4,"type":"VEC2"}],"bufferViews":[{"buffer":0,"byteLength":48},
{"buffer":0,"byteOffset":48,"byteLength":6},{"buffer":0,"byteOffset":72,"byteLength":16},{"buffer":0,"byteOffset":56,"byteLength":2},
{"buffer":0,"byteOffset":60,"byteLength":12}],"buffers":[{"uri":"a.bin","byteLength":88}]})";

template <class T>
void append(std::string& bytes, std::initializer_list<T> values) {
    for (const T value : values) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof value);
        bytes.append(raw, sizeof value);
    }
}

/// The corners, indices, sparse entry and uvs of kGltf.
std::string buffer() {
    std::string bytes;
    append<float>(bytes, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    append<std::uint8_t>(bytes, {0, 1, 2, 2, 1, 3, 0, 0});
    append<std::uint16_t>(bytes, {3, 0});
    append<float>(bytes, {5, 6, 7});
    append<std::uint16_t>(bytes, {0, 0, 65535, 0, 0, 65535, 65535, 65535});
    return bytes;
}

/// kGltf and its buffer in one file (glTF 2.0, section 4.4).
std::string glb() {
    std::string json = replaced(kGltf, R"("uri":"a.bin",)", ""), bin = buffer();
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t n) { return static_cast<std::uint32_t>(n); };
    std::string bytes = "glTF";
    append<std::uint32_t>(bytes, {2, word(12 + 8 + json.size() + 8 + bin.size()), word(json.size())});
    bytes += "JSON" + json;
    append<std::uint32_t>(bytes, {word(bin.size())});
    return bytes + std::string("BIN\0", 4) + bin;
}

/// Changes a letter, a number or a stretch; some changes leave the text as it is.
void break_text(std::string& text, std::mt19937& random) {
    static const std::vector<std::string> pieces = {
        "0",    "-1",   "1e31", "nan",  "4294967296", "-2147483649",        "1e-320",
        "\"",   "/",    "//",   "\\\n", "#",          "\xEF\xBB\xBF",       "{",
        "]",    ",",    " ",    "\n",   "\r",         std::string(1, '\0'), "-s",
        "\xff", "5125", "true", "null", "255"};
    if (text.empty()) return;
    const std::size_t at = random() % text.size();
    switch (random() % 6) {
        case 0:
            text.erase(at, 1 + random() % 8);
            return;
        case 1:
            text[at] = static_cast<char>(random() % 256);
            return;
        case 2:
            text.insert(at, pieces[random() % pieces.size()]);
            return;
        case 3: {  // a number becomes another one
            const std::size_t digit = text.find_first_of("0123456789", at);
            if (digit == std::string::npos) return;
            const std::size_t end = text.find_first_not_of("0123456789.e", digit);
            text.replace(digit, std::min(end, text.size()) - digit, pieces[random() % 7]);
            return;
        }
        case 4: {  // a stretch once more elsewhere
            const std::string stretch = text.substr(at, 1 + random() % 40);
            text.insert(random() % text.size(), stretch);
            return;
        }
        default:
            if (random() % 4 == 0) text.resize(at);
            return;
    }
}

int rounds() {
    const char* wanted = std::getenv("TRILENS_FUZZ_ROUNDS");
    return wanted ? std::atoi(wanted) : 1500;
}
unsigned seed() {
    const char* wanted = std::getenv("TRILENS_FUZZ_SEED");
    return wanted ? static_cast<unsigned>(std::atoi(wanted)) : 60;
}

void check_whole(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
        for (const IdTriple& triangle : mesh.object.triangles)
            for (const Id corner : triangle) REQUIRE(corner < mesh.object.points.size());
        REQUIRE(mesh.object.material.size() == mesh.object.triangles.size());
        for (const Id material : mesh.object.material) REQUIRE(material < scene.materials.size());
        for (const Vec3& point : mesh.object.points) REQUIRE(std::isfinite(point.x + point.y + point.z));
        for (const Vec3& point : mesh.cage.points) REQUIRE(std::isfinite(point.x + point.y + point.z));
    }
}

}  // namespace

TEST_CASE("law: broken model files load or say what is wrong in which file", "[scene][bad-input][law]") {
    const std::string folder = scratch_dir("scene_fuzz_files"), file = folder + "/room.json";
    const std::map<std::string, std::string> good = {
        {"a.obj", kObj}, {"a.mtl", kMtl}, {"a.gltf", kGltf}, {"a.bin", buffer()}, {"a.glb", glb()}};
    const auto write = [&](const std::string& name, const std::string& bytes) {
        std::ofstream(folder + "/" + name, std::ios::binary) << bytes;
    };
    for (const auto& [name, bytes] : good) write(name, bytes);
    for (const char* picture : {"/brick.png", "/brick wall.png", "/b.png"})
        std::ofstream(folder + picture) << "a picture";
    const auto load = [&](const std::string& model, bool optic) {
        const std::string mesh =
            optic ? R"({"role":"optic","material":"chrome","file":")" : R"({"role":"object","file":")";
        check_whole(load_text(kRoom, {{"/meshes/2", mesh + model + "\"}"}}, file));
    };
    for (const char* model : {"a.obj", "a.gltf", "a.glb"}) load(model, false);

    std::mt19937 random(seed());
    std::map<std::string, int> loaded, refused;
    for (int i = 0; i < rounds(); ++i) {
        auto broken = good.begin();
        std::advance(broken, random() % good.size());
        std::string bytes = broken->second;
        for (unsigned k = 1 + random() % 3; k > 0; --k) break_text(bytes, random);
        write(broken->first, bytes);
        const std::string model = broken->first == "a.mtl"   ? "a.obj"
                                  : broken->first == "a.bin" ? "a.gltf"
                                                             : broken->first;
        try {
            load(model, model == "a.obj" && random() % 2 == 0);
            ++loaded[broken->first];
        } catch (const InputError& error) {
            ++refused[broken->first];
            INFO(bytes);
            REQUIRE(begins_with(error.what(), file + ": /meshes/2"));
            REQUIRE(std::string(error.what()).find('\n') == std::string::npos);
        }
        write(broken->first, broken->second);
    }
    for (const auto& [name, bytes] : good) {
        INFO(name);
        CHECK(loaded[name] > rounds() / 100);
        CHECK(refused[name] > rounds() / 200);
    }
}
