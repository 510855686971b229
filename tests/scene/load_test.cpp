// What a good scene becomes.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>

#include "scene/read/override.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a scene file becomes plain data", "[scene]") {
    const Scene scene = load_text(kRoom);
    CHECK(scene.file == "room.json");
    CHECK(scene.film.width == 64);
    CHECK(scene.film.spp == 2);

    REQUIRE(scene.cameras.size() == 2);
    CHECK(scene.cameras[0].eye == Vec3(0, 1, 4));
    CHECK(std::get<PerspectiveCamera>(scene.cameras[0].kind).yfov == 40);
    const auto& rays = std::get<RayMeshCamera>(scene.cameras[1].kind);
    CHECK(rays.directions[2] == Vec3(0, 0, -2));
    CHECK(rays.triangles[0] == IdTriple{0, 1, 2});

    REQUIRE(scene.materials.size() == 3);
    CHECK(scene.materials[1].attenuation_color == Vec3(1, 0.5, 1));
    CHECK(scene.materials[1].attenuation_distance == 2);
    CHECK(scene.materials[2].unlit);

    REQUIRE(scene.meshes.size() == 3);
    const Mesh &cage = scene.meshes[0], &ball = scene.meshes[1], &wall = scene.meshes[2];
    CHECK(cage.role == Role::kOptic);
    CHECK(cage.material == 1);
    CHECK(cage.cage.points[2] == Vec3(1, 2, 1));  // scaled by 2 along Y, moved by 1 along Z
    CHECK(cage.cage.interpolate_boundary == InterpolateBoundary::kEdgeOnly);
    CHECK(cage.cage.crease_lengths == std::vector<int>{3});
    CHECK(cage.normals.type == NormalOverride::Type::kNoise);
    CHECK(cage.normals.seed == 7);
    REQUIRE(ball.primitive);
    CHECK(ball.resolution == 8);
    CHECK(wall.object.triangles == std::vector<IdTriple>{{0, 1, 2}, {0, 2, 3}});
    CHECK(wall.object.material == std::vector<Id>{2, 2});
    CHECK(wall.object.uvs[1][1] == Vec2(1, 1));

    REQUIRE(scene.lights.size() == 3);
    CHECK(length(std::get<DirectionalLight>(scene.lights[0].kind).direction) == Approx(1));
    CHECK(scene.lights[0].shadows);
    CHECK(std::get<PointLight>(scene.lights[1].kind).position == Vec3(2, 3, 2));
    CHECK(scene.render.reflect);
}

TEST_CASE("the resolved scene is one line that loads as the same scene", "[scene]") {
    const Scene scene = load_text(kRoom, {{"/film/width", "99"}, {"/render/paths", "[\"reflect\"]"}});
    CHECK(scene.resolved.find('\n') == std::string::npos);
    const Scene again = load_text(scene.resolved);
    CHECK(again.resolved == scene.resolved);
    CHECK(again.film.width == 99);
    CHECK_FALSE(again.render.direct);
    CHECK(again.meshes[0].cage.points == scene.meshes[0].cage.points);
}

TEST_CASE("comments and free keys and the smallest scene", "[scene]") {
    const std::string small = R"({ "version": 1, // a comment
        /* another */ "x-tool": { "any": [1, {"thing": null}] }, "extras": 3,
        "cameras": [ { "lookAt": { "eye": [0,0,1], "at": [0,0,0], "x-why": 1 } } ] })";
    const Scene scene = load_text(small);
    CHECK(scene.cameras[0].name == "camera0");
    CHECK(scene.cameras[0].up == Vec3(0, 1, 0));
    REQUIRE(scene.warnings.size() == 1);
    CHECK(scene.warnings[0] == "room.json: the scene has no meshes");
}

TEST_CASE(
    "a body of glass whose faces look inside is told of, a mirror and one turned by its transform are not",
    "[scene]") {
    const auto told = [](const std::string& faces, const std::string& material, const std::string& more) {
        const Scene scene = load_text(
            R"({"version": 1, "cameras": [{"lookAt": {"eye": [0,0,5], "at": [0,0,0]}}], "materials": [
                {"name": "glass", "transmissionFactor": 1}, {"name": "mirror", "metallicFactor": 1}], "meshes": [
                {"name": "cube", "role": "optic", "material": ")" +
            material +
            R"(", "points": [[-1,-1,-1],[-1,-1,1],[-1,1,-1],[-1,1,1],[1,-1,-1],[1,-1,1],[1,1,-1],[1,1,1]],
                "faceVertexCounts": [4,4,4,4,4,4], "faceVertexIndices": )" +
            faces + more + "}]}");
        return std::any_of(scene.warnings.begin(), scene.warnings.end(), [](const std::string& warning) {
            return warning.find("/meshes/0: the fronts of its faces look into it") != std::string::npos;
        });
    };
    const std::string out = "[0,1,3,2, 4,6,7,5, 0,4,5,1, 2,3,7,6, 0,2,6,4, 1,5,7,3]",
                      in = "[2,3,1,0, 5,7,6,4, 1,5,4,0, 6,7,3,2, 4,6,2,0, 3,7,5,1]";
    CHECK(told(in, "glass", ""));
    CHECK_FALSE(told(out, "glass", ""));
    CHECK_FALSE(told(in, "mirror", ""));
    CHECK_FALSE(told(out, "glass", R"(, "transform": {"scale": [-1, 1, 1]})"));
}

TEST_CASE("what is doubtful is a warning with its place", "[scene]") {
    const auto warned = [](const std::vector<SceneOverride>& overrides, const std::string& warning) {
        const Scene scene = load_text(kRoom, overrides);
        for (const std::string& found : scene.warnings)
            if (found == "room.json: " + warning) return true;
        for (const std::string& found : scene.warnings) UNSCOPED_INFO(found);
        return false;
    };
    CHECK(warned({{"/meshes/0/material", "chrome"}}, "/materials/1: the material 'glass' is not used"));
    CHECK(warned({},
                 "/meshes/0: 6 edges have one face only: this glass is one interface, or a body with holes"));
    CHECK(warned({{"/meshes/2/faceVertexIndices", "[0,1,1,3]"}}, "/meshes/2: 1 triangles have no area"));
    CHECK(warned(
        {{"/meshes/0/faceVertexIndices", "[0,1,2,3,1,2,5,4]"}},
        "/meshes/0: 1 edges are not manifold: more than two faces meet there, or their windings disagree"));
    CHECK(
        warned({{"/meshes/0/creaseIndices", "[0,1,3]"}}, "/meshes/0: 1 creases lie where there is no edge"));
    CHECK(warned({{"/meshes/1/name", "wall"}}, "/meshes/2: the name 'wall' is taken already"));
    CHECK(warned({{"/meshes/2/material", "glass"}},
                 "/meshes/2/material: a mirror or glass on an object is drawn as a plain surface: an optic "
                 "reflects and refracts"));
    CHECK(warned(
        {{"/materials/2/unlit", "false"}, {"/lights", "[]"}},
        "/lights: there is no light: every object whose material is neither unlit nor emissive is black"));
    CHECK(warned({{"/materials/0/emissiveFactor", "[1,0,0]"},
                  {"/materials/0/occlusionTexture", R"({"pattern": "checker"})"}},
                 "/meshes/1/material: the material 'chrome' of an optic: not drawn there: occlusionTexture, "
                 "emissiveFactor"));
    CHECK_FALSE(warned(
        {{"/lights", "[]"}},
        "/lights: there is no light: every object whose material is neither unlit nor emissive is black"));
}

TEST_CASE("creases come in chains or pairs with one sharpness per chain or edge", "[scene]") {
    const Scene pairs = load_text(
        replaced(kRoom, R"("creaseIndices": [0,1,2], "creaseLengths": [3], "creaseSharpnesses": [2.5])",
                 R"("creaseIndices": [0,1,1,2], "creaseSharpnesses": [1,2])"));
    CHECK(pairs.meshes[0].cage.crease_lengths == std::vector<int>{2, 2});
    const Scene per_edge = load_text(kRoom, {{"/meshes/0/creaseSharpnesses", "[1,2]"}});
    CHECK(per_edge.meshes[0].cage.crease_sharpnesses == std::vector<double>{1, 2});
}

TEST_CASE("holes of an object are not drawn and uvIndices pick uvs", "[scene]") {
    const Scene scene =
        load_text(kRoom, {{"/meshes/2/points", "[[0,0,0],[1,0,0],[1,1,0],[0,1,0],[2,0,0],[2,1,0]]"},
                          {"/meshes/2/faceVertexCounts", "[4,4]"},
                          {"/meshes/2/faceVertexIndices", "[0,1,2,3,1,4,5,2]"},
                          {"/meshes/2/uvs", "[[0,0],[1,1]]"},
                          {"/meshes/2/uvIndices", "[0,0,0,0,1,1,1,0]"},
                          {"/meshes/2/holeIndices", "[0]"}});
    CHECK(scene.meshes[2].face_count == 2);
    CHECK(scene.meshes[2].object.triangles == std::vector<IdTriple>{{1, 4, 5}, {1, 5, 2}});
    CHECK(scene.meshes[2].object.uvs[1] == std::array<Vec2, 3>{Vec2(1, 1), Vec2(1, 1), Vec2(0, 0)});
}

TEST_CASE("a background picture turns about the Y axis", "[scene]") {
    const std::string folder = scratch_dir("scene_background");
    std::ofstream(folder + "/sky.exr") << "stands for a picture";
    const std::string text =
        replaced(kRoom, R"({ "color": [0.2,0.3,0.5] })", R"({ "file": "sky.exr", "rotate": 390 })");
    const Scene scene = load_text(text, {}, folder + "/room.json");
    CHECK(scene.background.environment);
    CHECK(scene.background.rotate_cos == Approx(std::sqrt(0.75)));
    CHECK(scene.background.rotate_sin == Approx(0.5));
    CHECK(begins_with(error_of(text, {}, folder + "/elsewhere/room.json"),
                      folder + "/elsewhere/room.json: /background/file: the picture '"));
}

TEST_CASE("an override names an entry of an array by its name", "[scene]") {
    const Scene scene =
        load_text(kRoom, {{"/meshes/ball/resolution", "5"}, {"/materials/glass/ior", "1.33"}});
    CHECK(scene.meshes[1].resolution == 5);
    CHECK(scene.materials[1].ior == 1.33);
    const Scene without = load_text(kRoom, {{"/meshes/ball", "", true}, {"/cameras/rays", "", true}});
    CHECK(without.meshes.size() == 2);
    CHECK(without.cameras.size() == 1);
}

TEST_CASE("a resolution is every optic's, or one's by its name", "[scene]") {
    Scene scene = load_text(kRoom);
    set_resolution(scene, 3);
    set_resolution(scene, 12, "ball");
    CHECK(scene.meshes[0].resolution == 3);
    CHECK(scene.meshes[1].resolution == 12);
    CHECK(load_text(scene.resolved).meshes[1].resolution == 12);
    CHECK_THROWS_AS(set_resolution(scene, 12, "wall"), UsageError);  // an object
    CHECK(scene.meshes[1].resolution == 12);
}

TEST_CASE("ripples and dimples as heights are normal maps that meet at their squares' borders",
          "[scene][oracle]") {
    const double kTurn = 2 * 3.14159265358979323846;
    for (const std::string pattern : {"ripples", "dimples"}) {
        const Scene scene = load_text(
            kRoom, {{"/materials/2/normalTexture",
                     R"({"pattern":")" + pattern + R"(","count":[4,2],"heights":true,"scale":20})"}});
        const Material& material = scene.materials[2];
        CHECK(material.normal_scale == 20);
        const Texture& map = *material.normal_texture.picture;
        REQUIRE((map.width == 1024 && map.height == 1024));
        double worst = 0;
        for (int y = 0; y < map.height; ++y)
            for (int x = 0; x < map.width; ++x) {
                const float* rgb = &map.rgb[3 * static_cast<std::size_t>(y * map.width + x)];
                const Vec3 n = 2.0 * Vec3(rgb[0], rgb[1], rgb[2]) - Vec3(1);
                // By hand: slopes by texel; rows run downward.
                const double across = 4 * (x + 0.5) / 1024, down = 2 * (y + 0.5) / 1024;
                Vec2 slope = -kTurn / 4 * Vec2(std::sin(kTurn * across), std::sin(kTurn * down));
                if (pattern == "dimples") {
                    const Vec2 at(2 * (across - std::floor(across)) - 1, 2 * (down - std::floor(down)) - 1);
                    if (std::abs(length(at) - 1) < 0.02) continue;  // a bowl's rim is sharp
                    slope = length(at) < 1 ? 4.0 * at : Vec2(0);
                }
                const Vec3 expected = normalize(Vec3(-slope.x * 4 / 1024, slope.y * 2 / 1024, 1));
                worst = std::max(worst, length(n - expected));
            }
        INFO(pattern);
        CHECK(worst < 1e-5);
    }
    CHECK(error_with("/materials/2/baseColorTexture", R"({"pattern":"ripples","heights":true})") ==
          "room.json: /materials/2/baseColorTexture/heights: 'heights' is of 'normalTexture'");
}
