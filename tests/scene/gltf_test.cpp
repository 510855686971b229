// glTF and GLB objects: against files written by hand, against known models, and against broken ones.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "scene/formats/gltf.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kModels = "/usr/share/assimp/models";

template <class T>
void append_bytes(std::string& bytes, std::initializer_list<T> values) {
    for (const T value : values) {
        char raw[sizeof(T)];
        std::memcpy(raw, &value, sizeof value);
        bytes.append(raw, sizeof value);
    }
}

/// Four corners of a unit square (bytes 0..47), indices as uint8 0 1 2 2 1 3 (48..53, padded to 56), a sparse
/// index (uint16, 56..57, padded) and its value (60..71), uvs as normalised uint16 (72..87).
std::string square_buffer() {
    std::string bytes;
    append_bytes<float>(bytes, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    append_bytes<std::uint8_t>(bytes, {0, 1, 2, 2, 1, 3, 0, 0});
    append_bytes<std::uint16_t>(bytes, {3, 0});
    append_bytes<float>(bytes, {5, 6, 7});
    append_bytes<std::uint16_t>(bytes, {0, 0, 65535, 0, 0, 65535, 65535, 65535});
    return bytes;
}

struct Square {
    std::string primitive = R"("attributes":{"POSITION":0},"indices":1)";
    std::string nodes = R"([{"mesh":0}])";
    std::string scene_nodes = "[0]";
    std::string more;  // top-level members, each after a comma
    std::string position_accessor = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})";
};

std::string gltf_text(const Square& square) {
    return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":)" + square.scene_nodes +
           R"(}],"nodes":)" + square.nodes + R"(,"meshes":[{"primitives":[{)" + square.primitive +
           R"(}]}],"accessors":[)" + square.position_accessor +
           R"(,{"bufferView":1,"componentType":5121,"count":6,"type":"SCALAR"},{"bufferView":2,"componentType":5123,"normalized":true,"count":4,"type":"VEC2"}],
           "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":6},{"buffer":0,"byteOffset":72,"byteLength":16},
           {"buffer":0,"byteOffset":56,"byteLength":2},{"buffer":0,"byteOffset":60,"byteLength":12}],
           "buffers":[{"uri":"square.bin","byteLength":88}])" +
           square.more + "}";
}

std::string write_square(const std::string& folder, const std::string& text) {
    std::ofstream(folder + "/square.bin", std::ios::binary) << square_buffer();
    std::ofstream(folder + "/square.gltf") << text;
    return folder + "/square.gltf";
}

PolygonMesh read(const std::string& file) {
    const TextureReader textures = white_textures();
    return polygons_of_gltf(read_gltf(file), file, &textures);
}

std::string read_error(const std::string& file) {
    try {
        read(file);
        return "";
    } catch (const InputError& error) {
        REQUIRE(begins_with(error.what(), file));
        return std::string(error.what()).substr(file.size());
    }
}

}  // namespace

TEST_CASE("glTF triangles: lists and strips and fans with and without indices", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_modes");
    Square square;
    const auto indices = [&](const std::string& primitive) {
        square.primitive = primitive;
        return read(write_square(folder, gltf_text(square))).cage.face_vertex_indices;
    };
    CHECK(indices(R"("attributes":{"POSITION":0},"indices":1)") == std::vector<int>{0, 1, 2, 2, 1, 3});
    CHECK(indices(R"("attributes":{"POSITION":0},"mode":5)") == std::vector<int>{0, 1, 2, 1, 3, 2});
    CHECK(indices(R"("attributes":{"POSITION":0},"mode":6)") == std::vector<int>{0, 1, 2, 0, 2, 3});
    CHECK(indices(R"("attributes":{"POSITION":0},"mode":4)") == std::vector<int>{0, 1, 2});
    square.primitive = R"("attributes":{"POSITION":0},"mode":1)";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": no triangles in the default scene of this glTF");
}

TEST_CASE("glTF nodes: matrices and TRS through the hierarchy; mirrored ones keep their fronts", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_nodes");
    Square square;
    // Parent: a quarter turn about Z and a move along X. Child: scale 2 along X, move along Y.
    square.nodes =
        R"([{"children":[1],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"translation":[10,0,0]},
                       {"mesh":0,"matrix":[2,0,0,0, 0,1,0,0, 0,0,1,0, 0,3,0,1]}])";
    PolygonMesh mesh = read(write_square(folder, gltf_text(square)));
    // (1,1,0) -> child (2,4,0) -> turned (-4,2,0) -> moved (6,2,0)
    CHECK(length(mesh.cage.points[3] - Vec3(6, 2, 0)) < 1e-12);
    CHECK(mesh.cage.face_vertex_indices == std::vector<int>{0, 1, 2, 2, 1, 3});

    square.nodes = R"([{"mesh":0,"scale":[-1,1,1]}])";
    mesh = read(write_square(folder, gltf_text(square)));
    CHECK(mesh.cage.points[3] == Vec3(-1, 1, 0));
    CHECK(mesh.cage.face_vertex_indices == std::vector<int>{0, 2, 1, 2, 3, 1});

    square.nodes = R"([{"children":[1]},{"children":[0],"mesh":0}])";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /nodes/0: is its own ancestor: nodes must form a tree");
    square.nodes = R"([{"mesh":0,"rotation":[0,0,0,0]}])";
    CHECK(read_error(write_square(folder, gltf_text(square))) == ": /nodes/0: rotation must not be zero");
    square.nodes = R"([{"mesh":1}])";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /nodes/0/mesh: 1 is out of range: there are 1 meshes");
}

TEST_CASE("glTF accessors: sparse or normalised or out of bounds", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_accessors");
    Square square;
    const std::string sparse =
        R"("sparse":{"count":1,"indices":{"bufferView":3,"componentType":5123},"values":{"bufferView":4}})";
    square.position_accessor =
        R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)" + sparse + "}";
    CHECK(read(write_square(folder, gltf_text(square))).cage.points[3] == Vec3(5, 6, 7));
    square.position_accessor = R"({"componentType":5126,"count":4,"type":"VEC3",)" + sparse + "}";
    const PolygonMesh zeros = read(write_square(folder, gltf_text(square)));
    CHECK(zeros.cage.points[1] == Vec3(0));
    CHECK(zeros.cage.points[3] == Vec3(5, 6, 7));
    square.position_accessor = R"({"componentType":5126,"count":4,"type":"VEC3"})";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /accessors/0: has no buffer view (its data may be compressed)");
    square.position_accessor = R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"})";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /accessors/0: reaches beyond its buffer view");
    square.position_accessor = R"({"bufferView":0,"componentType":5126,"count":6,"type":"VEC2"})";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /accessors/0: must have entries of 3 components");
    square.position_accessor = R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /meshes/0/primitives/0/indices: index 3 is out of range: there are 3 vertices");

    square = Square();
    square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1)";
    const PolygonMesh mesh = read(write_square(folder, gltf_text(square)));
    CHECK(mesh.uvs[1] == Vec2(1, 1));  // v is turned upward
    CHECK(mesh.uvs[2] == Vec2(0, 0));
}

TEST_CASE("a texture of KTX2 alone is ignored with a word, one with another picture is that",
          "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_gltf_basisu");
    const auto model_with = [&](const std::string& texture) {
        Square square;
        square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0)";
        square.more =
            R"(,"extensionsUsed":["KHR_texture_basisu"],"materials":[{"name":"painted","pbrMetallicRoughness":
            {"baseColorTexture":{"index":0}}}],"textures":[{)" +
            texture +
            R"("extensions":{"KHR_texture_basisu":{"source":1}}}],"images":[{"uri":"a.png"},{"uri":"a.ktx2"}])";
        return read_gltf(write_square(folder, gltf_text(square)));
    };
    const std::string word = "a texture of KTX2 alone (KHR_texture_basisu) is ignored: KTX2 is not read";
    const auto says = [&](const GltfModel& model) {
        return std::any_of(model.warnings.begin(), model.warnings.end(),
                           [&](const std::string& warning) { return contains(warning, word); });
    };
    const GltfModel alone = model_with(""), beside = model_with(R"("source":0,)");
    CHECK(says(alone));
    CHECK(!alone.materials[0].written.contains("baseColorTexture"));
    CHECK(!says(beside));
    CHECK(beside.materials[0].written.at("baseColorTexture").at("image") == 0);
}

TEST_CASE("a texture has the picture of EXT_texture_webp where it has one", "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_gltf_webp");
    const auto file_with = [&](const std::string& before, const std::string& webp) {
        Square square;
        square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0)";
        square.more =
            R"(,"extensionsUsed":["EXT_texture_webp"],"extensionsRequired":["EXT_texture_webp"],"materials":[{"name":
            "painted","pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],"textures":[{)" +
            before + R"("extensions":{"EXT_texture_webp":)" + webp +
            R"(}}],"images":[{"uri":"a.png"},{"uri":"a.webp"}])";
        return write_square(folder, gltf_text(square));
    };
    for (const char* before : {"", R"("source":0,)"}) {
        const GltfModel model = read_gltf(file_with(before, R"({"source":1})"));
        CHECK((model.warnings.empty() && model.materials[0].written.at("baseColorTexture").at("image") == 1));
    }
    const std::string place = ": /textures/0/extensions/EXT_texture_webp";
    CHECK(read_error(file_with("", "{}")) == place + ": has no 'source'");
    CHECK(begins_with(read_error(file_with("", R"({"source":2})")), place + "/source: 2 is out of range"));
    // The library knows no WebP in a data URI: its bytes come all the same.
    Square square;
    square.more = R"(,"images":[{"uri":"data:image/webp;base64,UklGRg=="}])";
    CHECK(read_gltf(write_square(folder, gltf_text(square))).images[0].encoded ==
          std::vector<unsigned char>{'R', 'I', 'F', 'F'});
}

TEST_CASE("TEXCOORD_0 and TEXCOORD_1 are two sets of uv, and materials say which", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_two_uvs");
    Square square;
    square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_1":2},"indices":1,"material":0)";
    square.more = R"(,"materials":[{"occlusionTexture":{"index":0,"texCoord":1},
        "normalTexture":{"index":0,"extensions":{"KHR_texture_transform":{"texCoord":1}}},
        "emissiveFactor":[1,1,1],"emissiveTexture":{"index":0,"texCoord":3},
        "pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}],
        "textures":[{"source":0}],"images":[{"uri":"a.png"}])";
    const std::string file = write_square(folder, gltf_text(square));
    const PolygonMesh mesh = polygons_of_gltf(read_gltf(file), file, nullptr);
    CHECK(mesh.uvs[1] == Vec2(0, 0));
    CHECK(mesh.second_uvs[1] == Vec2(1, 1));
    CHECK(mesh.second_uvs[2] == Vec2(0, 0));
    const GltfModel model = read_gltf(file);
    const Json& written = model.materials[0].written;
    CHECK(written.at("occlusionTexture").at("texCoord") == 1);
    CHECK(written.at("normalTexture").at("texCoord") == 1);
    CHECK(!written.at("baseColorTexture").contains("texCoord"));
    CHECK(!written.at("emissiveTexture").contains("texCoord"));
    CHECK(model.warnings ==
          std::vector<std::string>{"sets of uv beyond TEXCOORD_1 are not read: the first is taken for them"});
}

TEST_CASE("what a glTF has beside meshes and base colours is told of", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_left_out");
    Square square;
    square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0)";
    square.more = R"(,"materials":[{"normalTexture":{"index":0},"occlusionTexture":{"index":0},
        "emissiveFactor":[0,1,0],"pbrMetallicRoughness":{"metallicRoughnessTexture":{"index":0}}},
        {"emissiveTexture":{"index":0}}],"textures":[{"source":0}],"images":[{"uri":"a.png"}],
        "cameras":[{"type":"perspective","perspective":{"yfov":0.7,"znear":0.1}}])";
    const GltfModel model = read_gltf(write_square(folder, gltf_text(square)));
    CHECK(model.warnings.empty());
    CHECK(model.cameras.size() == 1);
    CHECK(model.material_warnings ==
          std::vector<std::string>{"emissive maps are ignored", "light that materials emit is ignored",
                                   "metallic-roughness maps are ignored", "normal maps are ignored",
                                   "occlusion maps are ignored"});
}

TEST_CASE("glTF materials and their pictures", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_materials");
    Square square;
    square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0)";
    square.more =
        R"(,"materials":[{"name":"paint","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,1,1],"metallicFactor":0,
        "baseColorTexture":{"index":0}},"extensions":{"KHR_materials_unlit":{}}}],"textures":[{"source":0}],"images":[{"uri":"a%20b.png"}],
        "extensionsUsed":["KHR_materials_unlit"],"extensionsRequired":["KHR_materials_unlit"])";
    const std::string file = write_square(folder, gltf_text(square));
    const GltfModel model = read_gltf(file);
    REQUIRE(model.images.size() == 1);
    CHECK(model.images[0].file == folder + "/a b.png");

    const auto read_all = [&] {
        const TextureReader textures = white_textures();
        return polygons_of_gltf(model, file, &textures);
    };
    CHECK_THROWS_AS(read_all(), InputError);  // the picture is missing
    std::ofstream(folder + "/a b.png") << "stands for a picture";

    std::string asked;
    TextureReader textures = white_textures();
    textures.from_file = [&](const std::string& name) -> std::shared_ptr<const Texture> {
        asked = name;
        return white_textures().from_file(name);
    };
    const PolygonMesh mesh = polygons_of_gltf(model, file, &textures);
    CHECK(asked == folder + "/a b.png");
    REQUIRE(mesh.materials.size() == 1);
    CHECK(mesh.materials[0].base_color_factor == Vec3(0.5, 0.25, 1));
    CHECK(mesh.materials[0].unlit);
    CHECK(mesh.materials[0].metallic_factor == 0);
    CHECK(mesh.materials[0].base_color_texture);

    square.more = R"(,"images":[{"uri":"data:image/png;base64,iVBORw0KGgo="}],"textures":[{"source":0}],
        "materials":[{"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}])";
    std::size_t bytes = 0;
    textures.from_memory = [&](std::span<const unsigned char> encoded, const std::string& name) {
        bytes = encoded.size();
        return white_textures().from_memory(encoded, name);
    };
    polygons_of_gltf(read_gltf(write_square(folder, gltf_text(square))), file, &textures);
    CHECK(bytes == 8);

    square.more =
        R"(,"materials":[{}],"extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"])";
    CHECK(read_error(write_square(folder, gltf_text(square))) ==
          ": /extensionsRequired: the extension 'KHR_draco_mesh_compression' is required but not supported");
}

TEST_CASE("known glTF models", "[scene]") {
    if (!std::filesystem::exists(kModels + "/glTF2")) TRILENS_SKIP("needs assimp's test models");
    const std::map<std::string, std::size_t> triangles = {
        {"BoxTextured-glTF/BoxTextured.gltf", 12},
        {"BoxTextured-glTF-Binary/BoxTextured.glb", 12},
        {"BoxTextured-glTF-Embedded/BoxTextured.gltf", 12},
        {"2CylinderEngine-glTF-Binary/2CylinderEngine.glb", 121496},
        {"glTF-Sample-Models/AnimatedMorphCube-glTF/AnimatedMorphCube.gltf", 12}};
    for (const auto& [name, count] : triangles) {
        INFO(name);
        const PolygonMesh mesh = read(kModels + "/glTF2/" + name);
        CHECK(mesh.cage.face_vertex_counts.size() == count);
        CHECK(mesh.cage.face_vertex_indices.size() == 3 * count);
    }
    // The box lies under a node that turns Z up into Y up: its corners are still those of a unit cube.
    const PolygonMesh box = read(kModels + "/glTF2/BoxTextured-glTF/BoxTextured.gltf");
    Vec3 low(1e9), high(-1e9);
    for (const Vec3& point : box.cage.points) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    CHECK(length(low - Vec3(-0.5)) < 1e-12);
    CHECK(length(high - Vec3(0.5)) < 1e-12);
    REQUIRE(box.materials.size() == 1);
    CHECK(box.materials[0].base_color_texture);
}

TEST_CASE("the modes of Mesh_PrimitiveMode draw the same square", "[scene]") {
    const std::string folder = kModels + "/glTF2/glTF-Asset-Generator/Mesh_PrimitiveMode";
    if (!std::filesystem::exists(folder)) TRILENS_SKIP("needs assimp's test models");
    int drawn = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".gltf") continue;
        INFO(entry.path().string());
        const std::string error = read_error(entry.path().string());
        if (contains(error, "no triangles")) continue;  // points and lines
        REQUIRE(error == "");
        const PolygonMesh mesh = read(entry.path().string());
        CHECK(mesh.cage.face_vertex_counts.size() == 2);
        double area = 0;
        for (std::size_t i = 0; i < mesh.cage.face_vertex_indices.size(); i += 3) {
            const auto corner = [&](std::size_t k) {
                return mesh.cage.points[static_cast<std::size_t>(mesh.cage.face_vertex_indices[i + k])];
            };
            area += 0.5 * cross(corner(1) - corner(0), corner(2) - corner(0)).z;
        }
        CHECK(std::abs(area) == Approx(1).epsilon(1e-6));  // signed: both triangles turn the same way
        ++drawn;
    }
    CHECK(drawn >= 6);
}

TEST_CASE("every OBJ and glTF and GLB at hand loads or says why not", "[scene]") {
    if (!std::filesystem::exists(kModels)) TRILENS_SKIP("needs assimp's test models");
    int loaded = 0, refused = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kModels)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".obj" && extension != ".gltf" && extension != ".glb") continue;
        const std::string error =
            error_of(kRoom, {{"/meshes/2", R"({"role":"object","file":")" + entry.path().string() + "\"}"}});
        INFO(entry.path().string() << " -> " << error);
        CHECK((error.empty() || begins_with(error, "room.json: /meshes/2/file: ")));
        CHECK(error.find('\n') == std::string::npos);
        ++(error.empty() ? loaded : refused);
    }
    INFO(loaded << " loaded, " << refused << " refused");
    CHECK(loaded >= 20);
    CHECK(refused >= 5);
}

TEST_CASE("law: a broken glTF loads or says why not", "[scene][bad-input][law]") {
    const std::string folder = scratch_dir("scene_gltf_fuzz");
    Square square;
    square.primitive = R"("attributes":{"POSITION":0,"TEXCOORD_0":2},"indices":1,"material":0)";
    square.nodes =
        R"([{"children":[1],"rotation":[0,0,0,1],"scale":[1,1,1]},{"mesh":0,"matrix":[2,0,0,0,0,1,0,0,0,0,1,0,0,3,0,1]}])";
    square.position_accessor =
        R"({"bufferView":0,"byteOffset":0,"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":1,"indices":{"bufferView":3,"byteOffset":0,"componentType":5123},"values":{"bufferView":4,"byteOffset":0}}})";
    square.more =
        R"(,"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,1,1,1],"baseColorTexture":{"index":0}}}],"textures":[{"source":0}],
        "images":[{"uri":"data:image/png;base64,iVBORw0KGgo="}])";
    const std::string good = gltf_text(square);
    REQUIRE(read_error(write_square(folder, good)) == "");
    const std::vector<std::string> tokens = {"-1",          "0",     "1",   "4294967295", "4294967296",
                                             "-2147483648", "1e300", "0.5", "\"x\"",      "null",
                                             "[]",          "{}",    "[0]", "5120",       "999"};
    std::mt19937 random(3);
    int loaded = 0;
    for (int i = 0; i < 1500; ++i) {
        // Replace one number of the text by another token.
        std::string text = good;
        std::size_t at = random() % text.size();
        at = text.find_first_of("0123456789", at);
        if (at == std::string::npos) continue;
        const std::size_t end = text.find_first_not_of("0123456789.", at);
        text.replace(at, end - at, tokens[random() % tokens.size()]);
        INFO(text);
        loaded += read_error(write_square(folder, text)).empty();
    }
    CHECK(loaded > 100);
}
