// Colours at points: of glTF, OBJ and scene files, at the corners of the triangles that they colour.
#include "gltf_scene_text.h"

#include "scene/formats/gltf.h"
#include "scene/formats/obj.h"

using namespace trilens_test;

TEST_CASE("COLOR_0 goes with the corners of a glTF, three or four wide, cut to 0..1", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_colours");
    GltfBuffer buffer = make_buffer();
    const int four = buffer.add({1, 0, 0, 1, 0, 1, 0, 0.5, 0, 0, 1, 0.25, 2, -1, 0.5, 1}, "VEC4", 4);
    GltfParts parts;
    parts.primitive = R"({"attributes":{"POSITION":0,"COLOR_0":)" + std::to_string(four) +
                      R"(},"indices":1},{"attributes":{"POSITION":0},"indices":1})";
    const std::string file = write_gltf(folder, parts, buffer);
    const GltfModel model = read_gltf(file);
    CHECK(model.warnings.empty());
    const PolygonMesh mesh = polygons_of_gltf(model, file, nullptr);
    REQUIRE(mesh.colors.size() == mesh.cage.face_vertex_indices.size());
    for (std::size_t k = 0; k < mesh.colors.size(); ++k) {
        const std::vector<Vec4> of_point{{1, 0, 0, 1}, {0, 1, 0, 0.5}, {0, 0, 1, 0.25}, {1, 0, 0.5, 1}};
        const auto point = static_cast<std::size_t>(mesh.cage.face_vertex_indices[k]);
        CHECK(mesh.colors[k] == (point < 4 ? of_point[point] : Vec4(1)));
    }

    // Numbers of 16 bits stand for shares, and without alpha all is opaque.
    GltfBuffer narrow = make_buffer();
    const int three =
        narrow.add({65535, 0, 0, 0, 0, 65535, 0, 0, 0, 0, 65535, 0, 0, 0, 0, 0}, "VEC4", 4, 5123);
    const std::size_t at = narrow.accessors.rfind("\"type\":\"VEC4\"");
    narrow.accessors.insert(at, "\"normalized\":true,");
    parts.primitive =
        R"({"attributes":{"POSITION":0,"COLOR_0":)" + std::to_string(three) + R"(},"indices":1})";
    const std::string other = write_gltf(folder, parts, narrow);
    CHECK(polygons_of_gltf(read_gltf(other), other, nullptr).colors[1] == Vec4(0, 1, 0, 0));
}

TEST_CASE("morph targets of a glTF move colours and both sets of uv", "[scene]") {
    const std::string folder = scratch_dir("scene_gltf_morphed_colours");
    GltfBuffer buffer = make_buffer();
    const auto add = [&](const std::vector<double>& numbers, int width) {
        return std::to_string(buffer.add(numbers, "VEC" + std::to_string(width), width));
    };
    const std::string four = add({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, 4),
                      steps = add({-1, 1, 0, -1, 1, 0, -1, 1, 0, -1, 9, 0}, 3),
                      uvs = add({0, 0, 1, 0, 0, 1, 1, 1}, 2),
                      moves = add({0.5, 0.25, 0.5, 0.25, 0.5, 0.25, 0.5, 0.25}, 2);
    const std::string base = R"({"attributes":{"POSITION":0,"TEXCOORD_0":)" + uvs;
    const std::string target = R"(},"indices":1,"targets":[{"TEXCOORD_0":)" + moves + R"(,"TEXCOORD_1":)" +
                               moves + R"(,"COLOR_0":)" + steps + "}]}";
    GltfParts parts;
    parts.nodes = R"([{"mesh":0,"weights":[0.5]}])";
    parts.primitive = base + R"(,"TEXCOORD_1":)" + uvs + R"(,"COLOR_0":)" + four + target;
    const std::string file = write_gltf(folder, parts, buffer);
    const GltfModel model = read_gltf(file);
    CHECK(model.warnings.empty());
    const PolygonMesh mesh = polygons_of_gltf(model, file, nullptr);
    REQUIRE(mesh.colors.size() == 6);
    for (std::size_t k = 0; k < 6; ++k) {
        const auto point = static_cast<std::size_t>(mesh.cage.face_vertex_indices[k]);
        CHECK(mesh.colors[k] == Vec4(0.5, point == 3 ? 1 : 0.5, 0, 1));
        const Vec2 uv(static_cast<double>(point % 2) + 0.25, 1 - static_cast<double>(point / 2) - 0.125);
        CHECK(mesh.uvs[k] == uv);
        CHECK(mesh.second_uvs[k] == uv);
    }

    parts.primitive = base + target;
    const std::string bare = write_gltf(folder, parts, buffer);
    const GltfModel lacking = read_gltf(bare);
    REQUIRE(lacking.warnings.size() == 2);
    CHECK(lacking.warnings[0] == "a morph target's COLOR_0 is ignored: its primitive has none");
    CHECK(polygons_of_gltf(lacking, bare, nullptr).colors.empty());
}

TEST_CASE("a point of an OBJ may have a colour as screens have it", "[scene]") {
    const ObjFile obj = parse_obj("v 0 0 0 1 0.5 0\nv 1 0 0\nv 1 1 0 0 0 0.04\nf 1 2 3\n", "coloured.obj");
    REQUIRE(obj.mesh.colors.size() == 3);
    CHECK(obj.mesh.colors[0].y == Approx(0.21404114));  // IEC 61966-2-1
    CHECK(obj.mesh.colors[0].x == 1);
    CHECK(obj.mesh.colors[1] == Vec4(1));
    CHECK(obj.mesh.colors[2].z == Approx(0.04 / 12.92));
    CHECK(parse_obj("v 0 0 0 1\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "a.obj").mesh.colors.empty());
    const auto error = [](const std::string& point) {
        try {
            parse_obj(point + "\nv 1 0 0\nv 1 1 0\nf 1 2 3\n", "a.obj");
            return std::string();
        } catch (const InputError& failure) {
            return std::string(failure.what());
        }
    };
    CHECK(error("v 0 0 0 1 0 1.5") == "a.obj: line 1: a point's colour must lie in 0..1");
    CHECK(error("v 0 0 0 1 0 red") == "a.obj: line 1: 'red' is no number");
}

TEST_CASE("a scene's mesh has colours at its points, of a file or not, and optics have none", "[scene]") {
    const std::string colors = "[[1,0,0],[0,1,0,0.5],[0,0,1],[1,1,1]]";
    const Scene scene = load_text(kRoom, {{"/meshes/2/colors", colors}});
    REQUIRE(scene.meshes[2].object.colors.size() == 2);
    CHECK(scene.meshes[2].object.colors[1][1] == Vec4(0, 0, 1, 1));
    CHECK(scene.meshes[2].object.colors[0][1] == Vec4(0, 1, 0, 0.5));
    CHECK(error_with("/meshes/2/colors", "[[1,0,0]]") ==
          "room.json: /meshes/2/colors: has 1 entry, must have 4: one per entry of points");
    CHECK(error_with("/meshes/2/colors", "[[1,0,0],[0,1.5,0],[0,0,1],[1,1,1]]") ==
          "room.json: /meshes/2/colors/1/1: 1.5 is out of range: must be at most 1");
    CHECK(error_with("/meshes/0/colors", "[[1,0,0],[1,0,0],[1,0,0],[1,0,0],[1,0,0],[1,0,0]]") ==
          "room.json: /meshes/0/colors: are an object's: an optic has its material's colour alone");

    const std::string folder = scratch_dir("scene_obj_colours");
    std::ofstream(folder + "/a.obj") << "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 1 1 0 1 0 0\nf 1 2 3\n";
    const auto with = [&](const std::string& mesh) {
        std::ofstream(folder + "/a.json")
            << R"({"version":1,"cameras":[{"name":"c","yfov":40,"lookAt":{"eye":[0,0,4],"at":[0,0,0],"up":[0,1,0]}}],
                  "materials":[{"name":"grey","unlit":true},{"name":"chrome","metallicFactor":1}],
                  "meshes":[{"file":"a.obj",)" +
                   mesh + "}]}";
        return load_scene(folder + "/a.json", {}, white_textures());
    };
    const std::string object = R"("role":"object","material":"grey")";
    CHECK(with(object).meshes[0].object.colors[0][2] == Vec4(1, 0, 0, 1));
    CHECK(with(object + R"(,"vertexColors":false)").meshes[0].object.colors.empty());
    const Scene optic = with(R"("role":"optic","material":"chrome","subdivisionScheme":"loop")");
    REQUIRE(!optic.warnings.empty());
    bool told = false;
    for (const std::string& warning : optic.warnings)
        told = told || contains(warning, "the colours of its points are ignored: it is an optic");
    CHECK(told);
}

TEST_CASE("of a mask the alpha of points cuts nothing, and a warning says so", "[scene]") {
    const std::string mask = R"([{"name":"chrome","metallicFactor":1},{"name":"glass","transmissionFactor":1},
        {"name":"red","unlit":true,"alphaMode":"mask"}])";
    const Scene scene = load_text(
        kRoom, {{"/materials", mask}, {"/meshes/2/colors", "[[1,0,0],[0,1,0,0.1],[0,0,1],[1,1,1]]"}});
    CHECK(scene.meshes[2].object.triangles.size() == 2);
    bool told = false;
    for (const std::string& warning : scene.warnings)
        told = told || contains(warning, "1 triangles of a mask have colours with an alpha at their points");
    CHECK(told);
}
