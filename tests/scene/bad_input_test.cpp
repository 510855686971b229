// Every kind of bad input ends in one message with its file, its place and its reason.
#include <fstream>

#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Bad {
    const char* pointer;
    const char* value;
    const char* message;  // after "room.json: "
};

void check_all(std::initializer_list<Bad> cases) {
    for (const Bad& bad : cases) {
        INFO(bad.pointer << " = " << bad.value);
        CHECK(error_with(bad.pointer, bad.value) == std::string("room.json: ") + bad.message);
    }
}

}  // namespace

TEST_CASE("the room that the others break is good", "[scene]") {
    CHECK(error_of(kRoom) == "");
}

TEST_CASE("files that are missing or unreadable or no JSON", "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_bad_files");
    const auto error = [&](const std::string& file) {
        try {
            load_scene(file, {}, white_textures());
        } catch (const InputError& failure) {
            return std::string(failure.what());
        }
        return std::string();
    };
    CHECK(error(folder + "/none.json") == folder + "/none.json: cannot be opened: No such file or directory");
    CHECK(error(folder) == folder + ": is a directory, not a file");
    for (const char* nothing : {"", "\n", " \t\r\n "}) {
        std::ofstream(folder + "/empty.json") << nothing;
        CHECK(error(folder + "/empty.json") == folder + "/empty.json: is empty");
    }
    std::ofstream(folder + "/binary.json") << std::string(
        "\x7f"
        "ELF\0\1\2",
        7);
    CHECK(
        begins_with(error(folder + "/binary.json"), folder + "/binary.json: line 1, column 1: syntax error"));
    std::ofstream(folder + "/good.json") << kRoom;
    CHECK(error(folder + "/good.json") == "");
}

TEST_CASE("syntax errors come with line and column in one line", "[scene]") {
    const std::string trailing = error_of("{\n  \"version\": 1,\n  \"cameras\": [],\n}");
    CHECK(begins_with(trailing, "room.json: line 4, column 1: syntax error"));
    CHECK(trailing.find('\n') == std::string::npos);
    CHECK(begins_with(error_of("{ \"version\": 1 ]"), "room.json: line 1, column 16: syntax error"));
    CHECK(begins_with(error_of("{ \"version\": NaN }"), "room.json: line 1, column 14: syntax error"));
    CHECK(begins_with(error_of("{ \"version\":\n 1e999 }"), "room.json: line 2, column 6: number overflow"));
    CHECK(error_of(std::string(100, '[')) == "room.json: /0" + [] {
        std::string pointer;
        for (int i = 1; i < 64; ++i) pointer += "/0";
        return pointer;
    }() + ": nested deeper than 64 levels");
}

TEST_CASE("a key that stands twice is an error", "[scene][bad-input]") {
    CHECK(error_of(replaced(kRoom, "\"spp\": 2", "\"width\": 2")) ==
          "room.json: /film/width: this key stands twice in its object");
    CHECK(error_of(replaced(kRoom, "\"ior\": 1.5", "\"ior\": 1.5, \"ior\": 1.5")) ==
          "room.json: /materials/1/ior: this key stands twice in its object");
}

TEST_CASE("an unknown key is named with the nearest known one", "[scene][bad-input]") {
    CHECK(error_of(replaced(kRoom, "\"materials\"", "\"meterials\"")) ==
          "room.json: /meterials: unknown key 'meterials' of a scene; did you mean 'materials'?");
    CHECK(error_of(replaced(kRoom, "\"yfov\"", "\"yFov\"")) ==
          "room.json: /cameras/0/yFov: unknown key 'yFov' of a camera; did you mean 'yfov'?");
    CHECK(error_of(replaced(kRoom, "\"attenuationColor\"", "\"attenuationColour\"")) ==
          "room.json: /materials/1/volume/attenuationColour: unknown key 'attenuationColour' of a volume; "
          "did you mean 'attenuationColor'?");
    CHECK(error_of(replaced(kRoom, "\"spp\"", "\"a/b~c\"")) ==
          "room.json: /film/a~1b~0c: unknown key 'a/b~c' of a film; known: width, height, spp, filter");
    CHECK(error_of(replaced(kRoom, "\"radius\": 1", "\"height\": 1")) ==
          "room.json: /meshes/1/primitive/height: 'height' is no key of a sphere");
}

TEST_CASE("what a message quotes does not break its line", "[scene]") {
    CHECK(error_of(replaced(kRoom, "\"spp\"", "\"s\\np\"")) ==
          "room.json: /film/s p: unknown key 's p' of a film; did you mean 'spp'?");
    CHECK(error_with("/meshes/2/material", "\"a\\nb\"") ==
          "room.json: /meshes/2/material: unknown material 'a b'; known: chrome, glass, red");
}

TEST_CASE("wrong types and ranges and lengths", "[scene]") {
    check_all({
        {"/version", "2", "/version: the number 2 is not 1"},
        {"/film", "[1]", "/film: expected an object, found an array of 1"},
        {"/film/width", "\"wide\"", "/film/width: expected an integer, found the string \"wide\""},
        {"/film/width", "64.5", "/film/width: expected an integer, found the number 64.5"},
        {"/film/width", "0", "/film/width: 0 is out of range: must be at least 1"},
        {"/film/width", "-3", "/film/width: -3 is out of range: must be at least 1"},
        {"/film/height", "1e20", "/film/height: 1e+20 is out of range: must be at most 32768"},
        {"/film", R"({"width":32768,"height":32768})", "/film: 32768 x 32768 pixels are more than 268435456"},
        {"/film/spp", "65", "/film/spp: 65 is out of range: must be at most 64"},
        {"/cameras", "[]", "/cameras: has 0 entries, must have at least 1"},
        {"/cameras/0/yfov", "180", "/cameras/0/yfov: 180 is out of range: must be less than 180"},
        {"/cameras/0/yfov", "0", "/cameras/0/yfov: 0 is out of range: must be greater than 0"},
        {"/cameras/0/lookAt/eye", "[0,1]", "/cameras/0/lookAt/eye: has 2 entries, must have 3"},
        {"/cameras/0/lookAt/eye", "[0,1,1e31]",
         "/cameras/0/lookAt/eye/2: 1e+31 is out of range: must be at most 1e+30"},
        {"/cameras/0/lookAt/eye", "[0,1,\"nan\"]",
         "/cameras/0/lookAt/eye/2: expected a number, found the string \"nan\""},
        {"/cameras/0/lookAt/eye/1", "1e999",
         "/cameras/0/lookAt/eye/1: expected a number, found the string \"1e999\""},
        {"/cameras/0/type", "ortho",
         "/cameras/0/type: unknown value 'ortho'; known: perspective, orthographic, oblique, viewVolume, "
         "cylindrical, spherical, fisheye, opencv, pushbroom, crossedSlits, generalLinear, distortion, "
         "multiPerspective, inwardSphere, planarContext, rayMesh"},
        {"/cameras/0/type", "raymesh", "/cameras/0/type: unknown value 'raymesh'; did you mean 'rayMesh'?"},
        {"/cameras/0/type", "rayMesh", "/cameras/0: a rayMesh camera needs 'points'"},
        {"/cameras/1/type", "perspective", "/cameras/1: a perspective camera needs 'lookAt'"},
        {"/materials/0/baseColorFactor/1", "-0.1",
         "/materials/0/baseColorFactor/1: -0.1 is out of range: must be at least 0"},
        {"/materials/1/ior", "0", "/materials/1/ior: 0 is out of range: must be greater than 0"},
        {"/materials/1/ior", "11", "/materials/1/ior: 11 is out of range: must be at most 10"},
        {"/materials/0/unlit", "1", "/materials/0/unlit: expected a boolean, found the number 1"},
        {"/meshes/0/resolution", "0", "/meshes/0/resolution: 0 is out of range: must be at least 1"},
        {"/meshes/0/resolution", "1025", "/meshes/0/resolution: 1025 is out of range: must be at most 1024"},
        {"/meshes/0/faceVertexCounts/0", "2",
         "/meshes/0/faceVertexCounts/0: 2 is out of range: must be at least 3"},
        {"/meshes/0/faceVertexCounts/0", "300",
         "/meshes/0/faceVertexCounts/0: 300 is out of range: must be at most 255"},
        {"/meshes/0/creaseSharpnesses/0", "-1",
         "/meshes/0/creaseSharpnesses/0: -1 is out of range: must be at least 0"},
        {"/meshes/1/primitive/radius", "0",
         "/meshes/1/primitive/radius: 0 is out of range: must be greater than 0"},
        {"/meshes/1/primitive/type", "torus",
         "/meshes/1/primitive/type: unknown value 'torus'; known: sphere, paraboloid, cylinder, cone, plane, "
         "lens, box, disk"},
        {"/meshes/2/role", "mirror", "/meshes/2/role: unknown value 'mirror'; known: object, optic, terrain"},
        {"/lights/1/position", "null", "/lights/1/position: expected an array, found null"},
        {"/lights/0/intensity", "-1", "/lights/0/intensity: -1 is out of range: must be at least 0"},
        {"/render/paths", "[\"direct\",\"direct\"]",
         "/render/paths/1: the string \"direct\" stands there twice"},
        {"/render/paths", "[]", "/render/paths: has 0 entries, must have at least 1"},
    });
}

TEST_CASE("indices and lengths that do not fit each other", "[scene]") {
    check_all({
        {"/meshes/2/faceVertexIndices/3", "12",
         "/meshes/2/faceVertexIndices/3: index 12 is out of range: there are 4 points"},
        {"/meshes/2/faceVertexIndices/3", "-1",
         "/meshes/2/faceVertexIndices/3: -1 is out of range: must be at least 0"},
        {"/meshes/2/faceVertexCounts", "[3]",
         "/meshes/2/faceVertexIndices: has 4 entries, must have 3: the sum of faceVertexCounts"},
        {"/meshes/2/uvs", "[[0,0]]",
         "/meshes/2/uvs: has 1 entry, must have 4: without uvIndices one per entry of faceVertexIndices"},
        {"/meshes/2/uvIndices", "[0,1,2,4]",
         "/meshes/2/uvIndices/3: index 4 is out of range: there are 4 uvs"},
        {"/meshes/0/creaseIndices/0", "6",
         "/meshes/0/creaseIndices/0: index 6 is out of range: there are 6 points"},
        {"/meshes/0/creaseLengths", "[2]",
         "/meshes/0/creaseLengths: the lengths sum to 2, but creaseIndices has 3 entries"},
        {"/meshes/0/creaseSharpnesses", "[1,2,3]",
         "/meshes/0/creaseSharpnesses: has 3 entries, must have 1: one per chain, or one per edge (2)"},
        {"/meshes/0/cornerIndices", "[9]",
         "/meshes/0/cornerIndices/0: index 9 is out of range: there are 6 points"},
        {"/meshes/0/cornerSharpnesses", "[1,2]",
         "/meshes/0/cornerSharpnesses: has 2 entries, must have 1: one per entry of cornerIndices"},
        {"/meshes/0/holeIndices", "[2]",
         "/meshes/0/holeIndices/0: index 2 is out of range: there are 2 faces"},
        {"/meshes/0/subdivisionScheme", "loop",
         "/meshes/0/subdivisionScheme: loop needs triangles, but face 0 has 4 corners"},
        {"/cameras/1/directions", "[[0,0,1],[0,0,1],[0,0,1],[0,0,1]]",
         "/cameras/1/directions: has 4 entries, but points has 3"},
        {"/cameras/1/triangles/0/1", "3",
         "/cameras/1/triangles/0/1: index 3 is out of range: there are 3 points"},
    });
    CHECK(
        error_of(replaced(kRoom, "\"creaseLengths\": [3],", "")) ==
        "room.json: /meshes/0/creaseIndices: without creaseLengths the points go in pairs, but there are 3");
}

TEST_CASE("cameras and directions and transforms that mean nothing", "[scene][bad-input]") {
    check_all({
        {"/cameras/0/lookAt/at", "[0,1,4]",
         "/cameras/0/lookAt: eye and at are the same point: the camera looks nowhere"},
        {"/cameras/0/lookAt/up", "[0,-0.5,-2]",
         "/cameras/0/lookAt/up: up is parallel to the view from eye to at"},
        {"/cameras/0/lookAt/up", "[0,0,0]", "/cameras/0/lookAt/up: must not be zero"},
        {"/cameras/1/directions/2", "[0,0,0]", "/cameras/1/directions/2: a direction must not be zero"},
        {"/cameras/1/screen/1", "[6400,0]",
         "/cameras/1/screen/1/0: 6400 is out of range: must be at most 1000"},
        {"/lights/0/direction", "[0,0,0]", "/lights/0/direction: a direction must not be zero"},
        {"/meshes/0/transform/scale", "[1,0,1]",
         "/meshes/0/transform/scale/1: a scale of 0 flattens the mesh"},
        {"/meshes/0/transform/scale", "[1e30,1e30,1e31]",
         "/meshes/0/transform/scale/2: 1e+31 is out of range: must be at most 1e+30"},
        {"/meshes/0/transform/scale", "[1e30,1e30,1e30]",
         "/meshes/0: its transform carries points beyond coordinates of 1e30"},
        {"/meshes/0/transform/rotate", "[0,0,0,0]",
         "/meshes/0/transform/rotate: a quaternion must not be zero (0 0 0 1 turns nothing)"},
        {"/meshes/0/transform/rotate", "[0,90,0]",
         "/meshes/0/transform/rotate: has 3 entries, must have 4: a quaternion is x, y, z, w; angles in "
         "degrees "
         "are { \"euler\": [x, y, z] } or { \"axis\": [x, y, z], \"angle\": a }"},
        {"/meshes/0/transform/rotate", "90",
         "/meshes/0/transform/rotate: expected an array or an object, found the number 90"},
        {"/meshes/0/transform/rotate", "{}",
         "/meshes/0/transform/rotate: needs either 'euler' or 'axis' with 'angle'"},
        {"/meshes/0/transform/rotate", R"({"axis":[0,1,0]})",
         "/meshes/0/transform/rotate: 'axis' needs 'angle' beside it"},
        {"/meshes/0/transform/rotate", R"({"euler":[0,90,0],"order":"XXY"})",
         "/meshes/0/transform/rotate/order: unknown value 'XXY'; did you mean 'XZY'?"},
        {"/meshes/0/fit", R"({"center":[0,0,0]})", "/meshes/0/fit: a fit needs 'size'"},
        {"/meshes/0/transform/matrix", "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]",
         "/meshes/0/transform/translate: 'translate' is no key of a transform with a matrix"},
        {"/meshes/0/transform", R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]})",
         "/meshes/0/transform/matrix: its last row (entries 3, 7, 11, 15) must be 0 0 0 1"},
        {"/meshes/0/transform", R"({"matrix":[1,0,0,0,0,1,0,0,1,1,0,0,0,0,0,1]})",
         "/meshes/0/transform/matrix: is singular: it flattens the mesh"},
        {"/meshes/1/transform", R"({"scale":[1,2,1]})",
         "/meshes/1/transform: a primitive stays exact only under a uniform scale"},
        {"/meshes/1/primitive", R"({"type":"plane","normal":[0,0,0]})",
         "/meshes/1/primitive/normal: a direction must not be zero"},
        {"/meshes/1/primitive", R"({"type":"plane","normal":[0,0,2],"tangent":[0,0,-1]})",
         "/meshes/1/primitive/tangent: is parallel to the axis or normal"},
    });
}

TEST_CASE("materials that do not exist or do not fit", "[scene]") {
    check_all({
        {"/meshes/2/material", "read", "/meshes/2/material: unknown material 'read'; did you mean 'red'?"},
        {"/meshes/2/material", "mahogany",
         "/meshes/2/material: unknown material 'mahogany'; known: chrome, glass, red"},
        {"/meshes/2/material", "inherit",
         "/meshes/2/material: only a mesh with a file has materials to inherit"},
        {"/meshes/0/material", "red",
         "/meshes/0/material: the material 'red' of an optic must be a mirror (metallicFactor 1) or glass "
         "(transmissionFactor 1)"},
        {"/materials/0/roughnessFactor", "0.4",
         "/meshes/1/material: the material 'chrome' of an optic must have a roughnessFactor of at most 0.3"},
        {"/materials/0/roughnessFactor", "-0.1",
         "/materials/0/roughnessFactor: -0.1 is out of range: must be at least 0"},
        {"/render/roughSamples", "0", "/render/roughSamples: 0 is out of range: must be at least 1"},
        {"/render/roughTruthSamples", "1e9",
         "/render/roughTruthSamples: 1e+09 is out of range: must be at most 65536"},
        {"/materials/1/metallicFactor", "1",
         "/meshes/0/material: the material 'glass' of an optic cannot be mirror and glass at once"},
        {"/materials/1/name", "red", "/materials/2/name: the name 'red' is taken already"},
        {"/materials/1/name", "inherit",
         "/materials/1/name: 'inherit' is taken: it stands for a file's own materials"},
        {"/materials/1/name", "\"\"", "/materials/1/name: must not be empty"},
        {"/cameras/1/name", "main", "/cameras/1/name: the name 'main' is taken already"},
    });
}

TEST_CASE("keys that need or exclude each other", "[scene]") {
    check_all({
        {"/meshes/1/points", "[[0,0,0],[1,0,0],[0,1,0]]",
         "/meshes/1: 'points' needs 'faceVertexCounts' beside it"},
        {"/meshes/1/file", "ball.obj", "/meshes/1: a mesh has 'file' and 'primitive': only one may be given"},
        {"/meshes/1/primitive", R"({"type":"box","size":[1,1,1]})",
         "/meshes/1/primitive/type: a box is an object's: an optic is a sphere, a paraboloid, a cylinder, a "
         "cone, a plane, a lens, or a cage"},
        {"/meshes/1/primitive", R"({"type":"box"})", "/meshes/1/primitive: a box needs 'size'"},
        {"/meshes/1/primitive", R"({"type":"plane","size":[1,1,1]})",
         "/meshes/1/primitive/size: has 3 entries, must have 2 for a plane"},
        {"/meshes/1/primitive", R"({"type":"sphere","segments":9})",
         "/meshes/1/primitive/segments: are an object's: an optic is exact"},
        {"/meshes/1/fit", R"({"size":1})", "/meshes/1/fit: an optic's primitive has its own center and size"},
        {"/meshes/2", R"({"role":"object"})",
         "/meshes/2: a mesh needs one of 'points', 'file', 'primitive', 'heights' and 'patches'"},
        {"/meshes/1", R"({"role":"optic","primitive":{"type":"sphere"}})",
         "/meshes/1: an optic needs 'material'"},
        {"/background/rotate", "30", "/background: 'rotate' needs 'file' beside it"},
        {"/background/file", "sky.exr", "/background/color: 'color' is no key of a background with a file"},
        {"/background/zenith", "[0,0,1]", "/background: 'zenith' needs 'horizon' beside it"},
        {"/background", R"({"zenith":[0,0,1],"horizon":[1,1,1]})",
         "/background: 'zenith' needs 'ground' beside it"},
        {"/background", R"({"zenith":[0,0,1],"horizon":[1,1,1],"ground":[0,-1,0]})",
         "/background/ground/1: -1 is out of range: must be at least 0"},
        {"/background", R"({"zenith":[0,0,1],"horizon":[1,1,1],"ground":[0,0,0],"color":[1,1,1]})",
         "/background/color: 'color' is no key of a background with a sky"},
        {"/background", R"({"zenith":[0,0,1],"horizon":[1,1,1],"ground":[0,0,0],"file":"sky.exr"})",
         "/background/zenith: 'zenith' is no key of a background with a file"},
        {"/lights/0/position", "[1,2,3]", "/lights/0/position: 'position' is no key of a directional light"},
        {"/lights/2/type", "point", "/lights/2: a point light needs 'position'"},
    });
}

TEST_CASE("a point of an optic's cage far beyond the others is refused by name", "[scene][bad-input]") {
    // Half of the cage's points lie within 4 of its middle.
    const std::string far =
        "room.json: /meshes/0/points/4: lies more than 10000 times as far from the middle of the cage as "
        "half of its points do";
    CHECK(error_with("/meshes/0/points/4/0", "1e15") == far);
    CHECK(error_with("/meshes/0/points/4/2", "-50000") == far);
    CHECK(error_with("/meshes/0/points/4/0", "3e4").empty());
    CHECK(error_with("/meshes/2/points/0/0", "1e15").empty());  // an object
    const std::string folder = scratch_dir("scene_far_point"), file = folder + "/room.json";
    std::ofstream(folder + "/a.obj") << "v 9e9 9e9 9e9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 4 5\n";
    const std::vector<SceneOverride> mesh = {
        {"/meshes/0", R"({"role":"optic","material":"glass","file":"a.obj"})"}};
    CHECK(error_of(kRoom, mesh, file).empty());  // no face uses the far point
    std::ofstream(folder + "/a.obj")
        << "v 0 0 0\nv 1 0 0\nv 1 1e9 0\nv 0 1 0\nv -1 0 0\nf 1 2 3 4\nf 1 4 5\n";
    const std::string error = error_of(kRoom, mesh, file);
    CHECK(begins_with(error, file + ": /meshes/0/file: point 3 of the file lies more than 10000 times"));
}

TEST_CASE("files that a scene names", "[scene]") {
    const std::string folder = scratch_dir("scene_bad_names");
    const std::string file = folder + "/room.json";
    const auto error = [&](const std::string& pointer, const std::string& value) {
        return error_of(kRoom, {{pointer, value}}, file);
    };
    CHECK(error("/materials/2/baseColorTexture", "brick.png") ==
          file + ": /materials/2/baseColorTexture: the picture '" + folder + "/brick.png' does not exist");

    const auto mesh = [](const std::string& name) { return R"({"role":"object","file":")" + name + "\"}"; };
    CHECK(error("/meshes/2", mesh("none.obj")) ==
          file + ": /meshes/2/file: " + folder + "/none.obj: cannot be opened: No such file or directory");
    CHECK(error("/meshes/2", mesh("pawn.stl")) ==
          file + ": /meshes/2/file: '" + folder +
              "/pawn.stl' is of no known kind: known are .obj, .gltf and .glb");
    CHECK(error("/meshes/2", mesh("pawn.usdz")) ==
          file + ": /meshes/2/file: '" + folder +
              "/pawn.usdz' is USD, which is not read: export glTF (.glb) or OBJ instead");

    std::ofstream obj(folder + "/round.obj");
    for (int i = 0; i < 300; ++i) obj << "v " << i << " 0 0\n";
    obj << "f";
    for (int i = 1; i <= 300; ++i) obj << " " << i;
    obj.close();
    CHECK(error("/meshes/2", mesh("round.obj")) ==
          file + ": /meshes/2/file: " + folder +
              "/round.obj: line 301: a face may have at most 255 corners, found 300");
}

TEST_CASE("a picture that cannot be read is named with its place in the scene", "[scene][bad-input]") {
    const std::string folder = scratch_dir("scene_bad_picture");
    std::ofstream(folder + "/brick.png") << "no picture";
    TextureReader reader;
    reader.from_file = [](const std::string& file) -> std::shared_ptr<const Texture> {
        throw InputError(file, "", "is no picture");
    };
    const std::vector<SceneOverride> overrides = {{"/materials/2/baseColorTexture", "brick.png"}};
    try {
        load_scene_text(kRoom, folder + "/room.json", overrides, reader);
        FAIL("it loaded");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()) ==
              folder + "/room.json: /materials/2/baseColorTexture: " + folder + "/brick.png: is no picture");
    }
}

TEST_CASE("overrides by JSON pointer", "[scene]") {
    const Scene scene =
        load_text(kRoom, {{"/film/width", "100"},
                          {"/cameras/0/name", "front"},          // no JSON: a string
                          {"/meshes/1/normals/type", "smooth"},  // added with the object on the way
                          {"/extras/any/thing", "[1,2]"},
                          {"/film/width", "200"}});
    CHECK(scene.film.width == 200);
    CHECK(scene.cameras[0].name == "front");
    CHECK(contains(scene.resolved, R"("extras":{"any":{"thing":[1,2]}})"));

    check_all({
        {"/film/widht", "3",
         "/film/widht: names nothing: unknown key 'widht'; did you mean 'width'? (in --set)"},
        {"/fill/width", "3",
         "/fill/width: names nothing: unknown key 'fill'; did you mean 'film'? (in --set)"},
        {"/meshes/3/role", "optic",
         "/meshes/3/role: no entry '3': the array has 3 entries, counted from 0 (in --set)"},
        {"/meshes/01/role", "optic",
         "/meshes/01/role: no entry '01': the array has 3 entries, counted from 0 (in --set)"},
        {"/meshes/-/role", "optic",
         "/meshes/-/role: no entry '-': the array has 3 entries, counted from 0 (in --set)"},
        {"/meshes/bal/role", "optic",
         "/meshes/bal/role: no entry 'bal': the array has 3 entries, counted from 0; did you mean 'ball'? "
         "(in "
         "--set)"},
        {"/film/width/0", "1", "/film/width/0: names nothing: the number 64 has no part '0' (in --set)"},
        {"film/width", "1", "film/width: 'film/width' is no JSON pointer: it must begin with '/' (in --set)"},
        {"/film~2", "1", "/film~2: '~' in a JSON pointer must be followed by 0 or 1 (in --set)"},
        {"/film", R"({"width":1,"width":2})",
         "/film (in --set): /width: this key stands twice in its object"},
    });
    CHECK(error_of(R"({"version":1,"cameras":[]})", {{"/materials/0/name", "red"}}) ==
          "room.json: /materials/0/name: names nothing: there is no 'materials' yet (in --set)");
}
