// OBJ files: strict, line by line, and the same polygons that tinyobjloader reads.
#include <filesystem>
#include <fstream>
#include <sstream>

#ifndef TINYOBJLOADER_USE_DOUBLE
#define TINYOBJLOADER_USE_DOUBLE
#endif
#include <tiny_obj_loader.h>

#include "scene/formats/obj.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string obj_error(const std::string& text) {
    try {
        parse_obj(text, "cage.obj");
        return "";
    } catch (const InputError& error) {
        return error.what();
    }
}

std::string read_text(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
}

const std::string kQuad = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";

}  // namespace

TEST_CASE("an OBJ becomes a cage with its tags", "[scene]") {
    const ObjFile obj = parse_obj(
        "# comment\nmtllib some file.mtl\nv 0 0 0\r\nv +1 0 0 1\nv 1 1 .5e0 # tail\nv 0 1 0\nv 2 0 0\nv 2 1 "
        "0\n"
        "vt 0.25 0.75\nvn 0 0 2\nusemtl my paint\nf 1/1/1 2//1 3/1 4\ng other\nusemtl none\nf -5 -2 \\\n -1 "
        "-4\n"
        "t crease 2/1/0 0 1 2.5\nt crease 2/1/0 1 2 10\nt corner 1/1/0 3 4\nt hole 1/0/0 1\nt "
        "interpolateboundary 1/0/0 2\n",
        "cage.obj");
    const Cage& cage = obj.mesh.cage;
    CHECK(cage.points.size() == 6);
    CHECK(cage.points[2] == Vec3(1, 1, 0.5));
    CHECK(cage.face_vertex_counts == std::vector<int>{4, 4});
    CHECK(cage.face_vertex_indices == std::vector<int>{0, 1, 2, 3, 1, 4, 5, 2});
    CHECK(cage.crease_indices == std::vector<int>{0, 1, 1, 2});
    CHECK(cage.crease_lengths == std::vector<int>{2, 2});
    CHECK(cage.crease_sharpnesses == std::vector<double>{2.5, 10});
    CHECK(cage.corner_indices == std::vector<int>{3});
    CHECK(cage.hole_indices == std::vector<int>{1});
    CHECK(cage.interpolate_boundary == InterpolateBoundary::kEdgeOnly);
    CHECK(obj.material_libraries == std::vector<std::string>{"some file.mtl"});
    CHECK(obj.material_names == std::vector<std::string>{"my paint", "none"});
    CHECK(obj.mesh.face_material == std::vector<Id>{0, 1});
    CHECK(obj.mesh.uvs[0] == Vec2(0.25, 0.75));
    CHECK(obj.mesh.uvs[1] == Vec2(0, 0));
    CHECK(obj.mesh.normals[1] == Vec3(0, 0, 2));
    CHECK(obj.mesh.normals[3] == Vec3(0));
    CHECK(obj.warnings.empty());
}

TEST_CASE("several edges in one crease tag are read as pairs with a warning", "[scene]") {
    const ObjFile obj = parse_obj(kQuad + "t crease 4/2/0 0 1 2 3 1 2\n", "cage.obj");
    CHECK(obj.mesh.cage.crease_indices == std::vector<int>{0, 1, 2, 3});
    CHECK(obj.mesh.cage.crease_sharpnesses == std::vector<double>{1, 2});
    CHECK(obj.warnings ==
          std::vector<std::string>{"line 6: a crease tag of several points is read as pairs"});
}

TEST_CASE("what is wrong in an OBJ comes with its line", "[scene][bad-input]") {
    CHECK(obj_error("") == "cage.obj: no faces: an OBJ without an 'f' line cannot be drawn");
    CHECK(obj_error("v 0 0\n") == "cage.obj: line 1: 'v' needs 3 numbers, found 2");
    CHECK(obj_error("v 0 0 x\n") == "cage.obj: line 1: 'x' is no number");
    CHECK(obj_error("v 0 0 nan\n") == "cage.obj: line 1: 'nan' is no number");
    CHECK(obj_error("\nv 0 inf 0\n") == "cage.obj: line 2: 'inf' is beyond the limit of 1e30");
    CHECK(obj_error("v 0 1e31 0\n") == "cage.obj: line 1: '1e31' is beyond the limit of 1e30");
    CHECK(obj_error("v 0 1e999 0\n") == "cage.obj: line 1: '1e999' is beyond the limit of 1e30");
    CHECK(obj_error(kQuad + "v 0 1e-999 0\n") == "");
    CHECK(obj_error(kQuad + "f 1 2\n") == "cage.obj: line 6: a face needs at least 3 corners, found 2");
    CHECK(obj_error(kQuad + "f 1 2 0\n") == "cage.obj: line 6: index 0: indices count from 1");
    CHECK(obj_error(kQuad + "f 1 2 5\n") == "cage.obj: line 6: index 5 is out of range: there are 4 points");
    CHECK(obj_error(kQuad + "f 1 2 -5\n") ==
          "cage.obj: line 6: index -5 is out of range: there are 4 so far");
    CHECK(obj_error(kQuad + "f 1 2 3.5\n") == "cage.obj: line 6: '3.5' is no integer");
    CHECK(obj_error(kQuad + "f 1/1 2/1 3/1\n") ==
          "cage.obj: line 6: index 1 is out of range: there are 0 texture coordinates");
    CHECK(obj_error(kQuad + "f 1//2 2//1 3//1\n") ==
          "cage.obj: line 6: index 2 is out of range: there are 0 normals");
    CHECK(obj_error(kQuad + "f 1 2 99999999999\n") == "cage.obj: line 6: '99999999999' is no integer");
    CHECK(obj_error(kQuad + "t crease 2/1/0 0 4 1\n") ==
          "cage.obj: line 6: index 4 is out of range: there are 4 points, counted from 0 in tags");
    CHECK(obj_error(kQuad + "t hole 1/0/0 1\n") ==
          "cage.obj: line 6: index 1 is out of range: there are 1 faces, counted from 0 in tags");
    CHECK(obj_error(kQuad + "t crease 2/1/0 0 1\n") ==
          "cage.obj: line 6: the tag announces 2/1/0 values, found 2");
    CHECK(obj_error(kQuad + "t crease 2/1/0 0 1 -1\n") ==
          "cage.obj: line 6: a sharpness must not be negative");
    CHECK(obj_error(kQuad + "t interpolateboundary 1/0/0 3\n") ==
          "cage.obj: line 6: interpolateboundary must be 0, 1 or 2");
    CHECK(obj_error(kQuad + "t crease 3/1/0 0 1 2 1\n") ==
          "cage.obj: line 6: the tag 'crease' has the wrong number of values");
}

TEST_CASE("two readers agree on the cages and models", "[scene][oracle]") {
    TRILENS_NEEDS_DATA("cages");
    int files = 0;
    for (const char* folder : {"/cages", "/models"}) {
        for (const auto& entry : std::filesystem::directory_iterator(data_dir() + folder)) {
            if (entry.path().extension() != ".obj") continue;
            INFO(entry.path().string());
            const std::string text = read_text(entry.path().string());
            const Cage cage = parse_obj(text, entry.path().string()).mesh.cage;

            tinyobj::attrib_t attributes;
            std::vector<tinyobj::shape_t> shapes;
            std::vector<tinyobj::material_t> materials;
            std::string warnings, errors;
            std::istringstream stream(text);
            REQUIRE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream, nullptr,
                                     false));
            std::vector<int> counts, indices;
            std::size_t creases = 0, corners = 0, holes = 0;
            for (const tinyobj::shape_t& shape : shapes) {
                for (const unsigned char count : shape.mesh.num_face_vertices) counts.push_back(count);
                for (const tinyobj::index_t& index : shape.mesh.indices)
                    indices.push_back(index.vertex_index);
            }
            for (const tinyobj::tag_t& tag :
                 shapes.back().mesh.tags) {  // tags pile up: the last shape has them all
                creases += tag.name == "crease" ? tag.intValues.size() / 2 : 0;
                corners += tag.name == "corner" ? tag.intValues.size() : 0;
                holes += tag.name == "hole" ? tag.intValues.size() : 0;
            }
            CHECK(cage.face_vertex_counts == counts);
            CHECK(cage.face_vertex_indices == indices);
            CHECK(cage.crease_lengths.size() == creases);
            CHECK(cage.corner_indices.size() == corners);
            CHECK(cage.hole_indices.size() == holes);
            REQUIRE(cage.points.size() * 3 == attributes.vertices.size());
            double largest = 0;
            for (std::size_t i = 0; i < attributes.vertices.size(); ++i)
                largest = std::max(
                    largest, std::abs(cage.points[i / 3][static_cast<int>(i % 3)] - attributes.vertices[i]) /
                                 std::max(1e-3, std::abs(attributes.vertices[i])));
            CHECK(largest < 1e-12);
            ++files;
        }
    }
    CHECK(files == 19);
}

TEST_CASE("cages load as optics and as objects and count the same", "[scene]") {
    TRILENS_NEEDS_DATA("cages/catmark_pawn.obj");
    const auto scene_with = [](const std::string& file, const std::string& role, const std::string& more) {
        return load_text(kRoom, {{"/meshes/0", R"({"role":")" + role + R"(","material":"chrome","file":")" +
                                                   data_dir() + file + "\"" + more + "}"}});
    };
    const Scene pawn = scene_with("/cages/catmark_pawn.obj", "optic", "");
    CHECK(pawn.meshes[0].face_count == 588);
    CHECK(pawn.meshes[0].cage.face_vertex_counts.size() == 588);
    const Scene hole = scene_with("/cages/catmark_hole_test1.obj", "object", "");
    CHECK(hole.meshes[0].face_count == 6);
    CHECK(hole.meshes[0].object.triangles.size() == 10);  // five quads: the hole is not drawn
    const Scene helmet = scene_with("/cages/catmark_helmet.obj", "optic", "");
    CHECK(helmet.meshes[0].cage.interpolate_boundary == InterpolateBoundary::kEdgeAndCorner);
    const Scene open = scene_with("/cages/catmark_helmet.obj", "optic", R"(,"interpolateBoundary":"none")");
    CHECK(open.meshes[0].cage.interpolate_boundary == InterpolateBoundary::kNothing);
    const Scene loop = scene_with("/cages/loop_icosahedron.obj", "optic", R"(,"subdivisionScheme":"loop")");
    CHECK(loop.meshes[0].face_count == 20);
    CHECK(loop.meshes[0].cage.scheme == SubdivisionScheme::kLoop);
    const Scene spot = scene_with("/models/spot.obj", "object", "");
    CHECK(spot.meshes[0].object.triangles.size() == 5856);
    CHECK(spot.meshes[0].object.uvs.size() == 5856);
}

TEST_CASE("an object inherits the materials of its MTL", "[scene]") {
    const std::string folder = scratch_dir("scene_mtl");
    std::ofstream(folder + "/a.obj")
        << "mtllib a.mtl\n" + kQuad +
               "usemtl deep red\nf 1 2 3\nusemtl brick\nf 1 3 4\nusemtl lost\nf 1 2 4\n";
    std::ofstream(folder + "/a.mtl") << "newmtl unused\nKd 1 1 1\nmap_Kd none.png\nnewmtl deep red\nKd 0.5 0 "
                                        "0\nnewmtl brick\nKd 1 1 1\nmap_Kd tex\\brick.png\n";
    std::filesystem::create_directory(folder + "/tex");
    const std::string mesh = R"({"name":"thing","role":"object","file":"a.obj"})",
                      file = folder + "/room.json";
    CHECK(error_of(kRoom, {{"/meshes/2", mesh}}, file) ==
          file + ": /meshes/2/file: " + folder +
              "/tex/brick.png: the picture of material 'brick' does not exist");
    std::ofstream(folder + "/tex/brick.png") << "stands for a picture";
    const Scene scene = load_text(kRoom, {{"/meshes/2", mesh}}, file);
    const Mesh& thing = scene.meshes[2];
    CHECK(thing.material == kNone);
    REQUIRE(scene.materials.size() == 6);
    CHECK(scene.materials[3].name == "thing/deep red");
    CHECK(scene.materials[3].base_color_factor == Vec3(0.5, 0, 0));
    CHECK(scene.materials[4].base_color_texture);
    CHECK(scene.materials[5].name == "thing/default");
    CHECK(thing.object.material == std::vector<Id>{5, 5, 3, 4, 5});
    bool warned = false;
    for (const std::string& warning : scene.warnings)
        warned =
            warned ||
            warning ==
                file + ": /meshes/2/file: the material 'lost' is in no library: drawn in the default colour";
    CHECK(warned);
}
