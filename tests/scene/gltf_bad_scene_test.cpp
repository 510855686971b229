// glTF scenes that are refused: the file, the place and one message; and random damage.
#include <filesystem>
#include <iterator>
#include <random>

#include "gltf_scene_text.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("bad glTF scenes: the file, the place and one message", "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_gltf_bad");
    struct Bad {
        GltfParts parts;
        std::string message;
    };
    const auto with = [](auto change) {
        GltfParts parts;
        change(parts);
        return parts;
    };
    const std::string animated =
        R"(,"animations":[{"samplers":[{"input":IN,"output":OUT}],"channels":[{"sampler":SAMPLER,"target":{"node":NODE,"path":"translation"}}]}])";
    const auto animation = [&](std::string in, std::string out, std::string sampler, std::string node) {
        return with([&](GltfParts& p) {
            p.more =
                replaced(replaced(replaced(replaced(animated, "IN", in), "OUT", out), "SAMPLER", sampler),
                         "NODE", node);
        });
    };
    const std::vector<Bad> all = {
        {with([](GltfParts& p) { p.nodes = R"([{"children":[1]},{"children":[0]}])"; }),
         ": /nodes/0: is its own ancestor: nodes must form a tree"},
        {with([](GltfParts& p) { p.nodes = R"([{"children":[0]}])"; }),
         ": /nodes/0: is its own ancestor: nodes must form a tree"},
        {with([](GltfParts& p) { p.nodes = R"([{"children":[2]},{"children":[2]},{"mesh":0}])"; }),
         ": /nodes/2: is a child of node 0 and of node 1: nodes must form a tree"},
        {with([](GltfParts& p) { p.roots = "[0,0]"; }),
         ": /scenes/0: node 0 is reached twice: nodes must form a tree"},
        {with([](GltfParts& p) { p.roots = "[5]"; }),
         ": /scenes/0/nodes/0: 5 is out of range: there are 1 nodes"},
        {with([](GltfParts& p) { p.nodes = R"([{"mesh":0,"skin":0}])"; }),
         ": /nodes/0/skin: 0 is out of range: there are 0 skins"},
        {with([](GltfParts& p) { p.nodes = R"([{"camera":3}])"; }),
         ": /nodes/0/camera: 3 is out of range: there are 0 cameras"},
        {with([](GltfParts& p) {
             p.nodes = R"([{"mesh":0,"extensions":{"KHR_lights_punctual":{"light":2}}}])";
         }),
         ": /nodes/0/extensions/KHR_lights_punctual/light: 2 is out of range: there are 0 lights"},
        {with([](GltfParts& p) { p.nodes = R"([{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]}])"; }),
         ": /nodes/0: the last row of matrix must be 0 0 0 1"},
        {with([](GltfParts& p) { p.nodes = R"([{"mesh":0,"translation":[1e31,0,0]}])"; }),
         ": /nodes/0: translation holds a number beyond 1e30"},
        {with([](GltfParts& p) {
             p.materials = R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
             p.more = R"(,"textures":[{"source":0}],"images":[{"uri":"none.png"}])";
         }),
         ": /images/0/uri: the picture '" + folder + "/none.png' does not exist"},
        {with([](GltfParts& p) {
             p.materials = R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
             p.more = R"(,"textures":[{"source":0}],"images":[{"bufferView":99,"mimeType":"image/png"}])";
         }),
         ": /images/0/bufferView: 99 is out of range: there are 11 bufferViews"},
        {with([](GltfParts& p) { p.materials = R"([{"extensions":{"KHR_materials_ior":{"ior":-1}}}])"; }),
         ": /materials/0/extensions/KHR_materials_ior/ior: the number -1 is no number in 0..1e+30"},
        {with([](GltfParts& p) { p.materials = R"([{"alphaMode":"SOFT"}])"; }),
         ": /materials/0/alphaMode: unknown value 'SOFT'; known: OPAQUE, MASK, BLEND"},
        {with([](GltfParts& p) { p.nodes = R"([{"mesh":0,"extras":{"trilens":3}}])"; }),
         ": /nodes/0/extras/trilens: is neither true, false nor an object of a mesh's keys, but the number "
         "3"},
        {with([](GltfParts& p) { p.more = R"(,"extensionsRequired":["EXT_of_tomorrow"])"; }),
         ": /extensionsRequired: the extension 'EXT_of_tomorrow' is required but not supported"},
        {with([](GltfParts& p) {
             p.more = R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0,"znear":1}}])";
         }),
         ": /cameras/0/perspective/yfov: is not above 0, or far too large"},
        {animation("6", "7", "1", "0"),
         ": /animations/0/channels/0/sampler: sampler 1 is out of range: there are 1"},
        {animation("6", "7", "0", "9"),
         ": /animations/0/channels/0/target/node: 9 is out of range: there are 1 nodes"},
        {animation("7", "7", "0", "0"), ": /accessors/7: must have entries of 1 components"},
        {animation("6", "0", "0", "0"),
         ": /animations/0/samplers/0/output: has 12 numbers, but its times need 6"},
        {animation("8", "99", "0", "0"),
         ": /animations/0/samplers/0/output: 99 is out of range: there are 11 accessors"},
    };
    for (const Bad& bad : all) {
        INFO(bad.message);
        CHECK(load_error(write_gltf(folder, bad.parts)) == bad.message);
    }
    // Numbers of the buffer that are none, or that lie about how many there are.
    GltfBuffer buffer = make_buffer();
    const float none = NAN;
    std::memcpy(buffer.bytes.data() + buffer.bytes.size() - 4, &none, 4);
    CHECK(
        load_error(write_gltf(
            folder, with([](GltfParts& p) {
                p.more =
                    R"(,"animations":[{"samplers":[{"input":6,"output":10}],"channels":[{"sampler":0,"target":{"node":0,"path":"rotation"}}]}])";
            }),
            buffer)) == ": /accessors/10: entry 1 holds a number that is not finite or beyond 1e30");
    buffer = make_buffer();
    buffer.bytes.resize(40);
    const std::string short_one = write_gltf(folder, GltfParts(), buffer);
    CHECK(contains(load_error(short_one), "reaches beyond its buffer"));
    // A picture in a buffer view that reaches beyond its buffer.
    buffer = make_buffer();
    buffer.views += R"(,{"buffer":0,"byteOffset":16,"byteLength":100000})";
    const GltfParts pictured = with([](GltfParts& p) {
        p.materials = R"([{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
        p.more = R"(,"textures":[{"source":0}],"images":[{"bufferView":11,"mimeType":"image/png"}])";
    });
    CHECK(load_error(write_gltf(folder, pictured, buffer)) ==
          ": /images/0: its buffer view reaches beyond its buffer");
}

TEST_CASE("glTF buffers that are not there, or not as long as they say: which, and both lengths",
          "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_gltf_buffers");
    const std::string file = folder + "/room.gltf";
    const auto error_of = [&](const std::string& buffers) {
        std::ofstream(file) << R"({"asset":{"version":"2.0"},"nodes":[{}],"buffers":[)" + buffers + "]}";
        return load_error(file);
    };
    std::ofstream(folder + "/ten bytes.bin") << "0123456789";
    CHECK(
        error_of(R"({"uri":"ten%20bytes.bin","byteLength":10},{"uri":"ten%20bytes.bin","byteLength":12})") ==
        ": /buffers/1/byteLength: is 12, but the buffer holds 10 bytes");
    CHECK(error_of(R"({"uri":"none.bin","byteLength":10})") ==
          ": /buffers/0/uri: the buffer 'none.bin' cannot be read");
    // One of that name where the program was started is another.
    const std::filesystem::path home = std::filesystem::current_path();
    std::filesystem::create_directories(folder + "/elsewhere");
    std::ofstream(folder + "/elsewhere/there.bin") << "0123456789";
    std::filesystem::current_path(folder + "/elsewhere");
    const std::string elsewhere = error_of(R"({"uri":"there.bin","byteLength":10})");
    std::filesystem::current_path(home);
    CHECK(elsewhere == ": /buffers/0/uri: the buffer 'there.bin' cannot be read");
    const std::string embedded = R"({"uri":"data:application/octet-stream;base64,)";
    for (const std::string length : {"0", "5", "1000000", "4611686018427387904"})
        CHECK(error_of(embedded + "AAAAAA==\",\"byteLength\":" + length + "}") ==
              ": /buffers/0/byteLength: is " + length + ", but the buffer holds 4 bytes");
    for (const std::string uri :
         {"data:", "data:,AAAA", "data:application/octet-stream,AAAA", "data:;base64"})
        CHECK(error_of(R"({"byteLength":3,"uri":")" + uri + "\"}") ==
              ": /buffers/0/uri: a data URI without ';base64,' is not read");
    // What it is called does not fill the screen.
    CHECK(
        error_of(R"({"uri":"data:none;base64,)" + std::string(4000, 'A') + R"(","byteLength":3000})").size() <
        300);
    // A GLB whose second chunk is too short.
    std::string json = R"({"asset":{"version":"2.0"},"nodes":[{}],"buffers":[{"byteLength":8}]})";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t number) {
        const auto value = static_cast<std::uint32_t>(number);
        std::string bytes(4, 0);
        std::memcpy(bytes.data(), &value, 4);
        return bytes;
    };
    const std::string binary = folder + "/room.glb";
    std::ofstream(binary, std::ios::binary) << "glTF" + word(2) + word(32 + json.size()) + word(json.size()) +
                                                   "JSON" + json + word(4) + std::string("BIN\0abcd", 8);
    CHECK(load_error(binary) == ": /buffers/0/byteLength: is 8, but the buffer holds 4 bytes");
}

TEST_CASE("glTF buffers longer than they say are read as far as they say", "[scene][gltf]") {
    const std::string folder = scratch_dir("scene_gltf_long_buffers");
    const std::string file = write_gltf(folder, GltfParts());
    const Scene exact = load(file);
    std::ifstream in(file);
    const std::string json{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    std::ofstream(folder + "/room.bin", std::ios::binary | std::ios::app) << std::string(5, 'x');
    // In a file, and beside one in a GLB's own second chunk, which nothing names.
    std::string padded = json;
    padded.resize((padded.size() + 3) / 4 * 4, ' ');
    const auto word = [](std::size_t number) {
        const auto value = static_cast<std::uint32_t>(number);
        return std::string(reinterpret_cast<const char*>(&value), sizeof value);
    };
    const std::string binary = folder + "/room.glb";
    std::ofstream(binary, std::ios::binary) << "glTF" + word(2) + word(32 + padded.size()) +
                                                   word(padded.size()) + "JSON" + padded + word(4) +
                                                   std::string("BIN\0abcd", 8);
    for (const std::string& longer : {file, binary}) {
        const Scene scene = load(longer);
        REQUIRE(scene.meshes.size() == 1);
        CHECK(scene.meshes[0].object.points == exact.meshes[0].object.points);
        CHECK(scene.meshes[0].object.triangles == exact.meshes[0].object.triangles);
    }
    // What lies beyond is no part of the buffer.
    GltfBuffer buffer = make_buffer();
    buffer.views +=
        R"(,{"buffer":0,"byteOffset":)" + std::to_string(buffer.bytes.size() - 4) + R"(,"byteLength":8})";
    buffer.accessors += R"(,{"bufferView":11,"componentType":5126,"count":2,"type":"SCALAR"})";
    GltfParts parts;
    parts.primitive = R"({"attributes":{"POSITION":0},"indices":11})";
    const std::string beyond = write_gltf(folder, parts, buffer);
    std::ofstream(folder + "/room.bin", std::ios::binary | std::ios::app) << std::string(8, 'x');
    CHECK(contains(load_error(beyond), "its buffer view reaches beyond its buffer"));
}

TEST_CASE("law: a broken glTF scene loads or says why not", "[scene][bad-input][law]") {
    const std::string folder = scratch_dir("scene_gltf_scene_fuzz");
    GltfParts parts;
    parts.primitive =
        R"({"attributes":{"POSITION":0,"JOINTS_0":3,"WEIGHTS_0":4},"indices":1,"material":0,"targets":[{"POSITION":2}]})";
    parts.nodes = R"([{"name":"square","mesh":0,"skin":0,"weights":[0.5]},{"children":[2],"camera":0},
        {"translation":[1,3,0],"extensions":{"KHR_lights_punctual":{"light":0}}}])";
    parts.roots = "[0,1]";
    parts.materials =
        R"([{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0},"alphaMode":"MASK","alphaCutoff":0.5,
        "emissiveFactor":[1,0,0],"extensions":{"KHR_materials_transmission":{"transmissionFactor":1},"KHR_materials_ior":{"ior":1.33},
        "KHR_materials_volume":{"attenuationColor":[0.5,1,1],"attenuationDistance":2},"KHR_materials_specular":{"specularFactor":0.5}}}])";
    parts.more =
        R"(,"skins":[{"joints":[1,2],"inverseBindMatrices":5}],"cameras":[{"type":"perspective","perspective":{"yfov":0.7,"aspectRatio":2,"znear":1}}],
        "extensions":{"KHR_lights_punctual":{"lights":[{"type":"spot","intensity":60,"range":3,"color":[1,0.5,0],"spot":{"innerConeAngle":0.1,"outerConeAngle":0.5}}]}},
        "animations":[{"samplers":[{"input":6,"output":9,"interpolation":"CUBICSPLINE"},{"input":6,"output":8}],
        "channels":[{"sampler":0,"target":{"node":1,"path":"translation"}},{"sampler":1,"target":{"node":0,"path":"weights"}}]}])";
    const std::string file = write_gltf(folder, parts);
    std::ifstream in(file);
    const std::string good{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    REQUIRE(load_error(file) == "");
    const std::vector<std::string> tokens = {"-1",  "0",     "1",    "2",  "4294967296", "1e300",
                                             "0.5", "\"x\"", "null", "[]", "{}",         "999"};
    std::mt19937 random(11);
    int loaded = 0, refused = 0;
    for (int i = 0; i < 700; ++i) {
        std::string text = good;
        std::size_t at = text.find_first_of("0123456789", random() % text.size());
        if (at == std::string::npos) continue;
        const std::size_t end = text.find_first_not_of("0123456789.", at);
        text.replace(at, end - at, tokens[random() % tokens.size()]);
        std::ofstream(file) << text;
        INFO(text);
        const std::string error = load_error(file);
        CHECK(error.find('\n') == std::string::npos);
        ++(error.empty() ? loaded : refused);
    }
    CHECK(loaded > 100);
    CHECK(refused > 100);
}

TEST_CASE("every glTF of assimp's test models is a scene or says why not", "[scene]") {
    const std::string models = "/usr/share/assimp/models";
    if (!std::filesystem::exists(models)) TRILENS_SKIP("needs assimp's test models");
    int loaded = 0, refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(models)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".gltf" && extension != ".glb") continue;
        const std::string error = load_error(entry.path().string());
        INFO(entry.path().string() << " -> " << error);
        CHECK(error.find('\n') == std::string::npos);
        ++(error.empty() ? loaded : refused);
    }
    INFO(loaded << " loaded, " << refused << " refused");
    CHECK(loaded >= 23);
}
