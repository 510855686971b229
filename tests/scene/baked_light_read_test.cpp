// Baked light out of scene files: what goes along when triangles are halved, and what is refused.
#include <algorithm>
#include <string>

#include "scene/data/baked_light.h"
#include "scene/scene_text.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A square of two triangles (0, 1, 2 and 0, 2, 3) whose uvs and colours are linear in its points.
std::string lit_square(const std::string& baked) {
    return R"({"version": 1, "cameras": [{"yfov": 40, "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
        "materials": [{"name": "m"}],
        "meshes": [{"name": "square", "role": "object", "material": "m", "points": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]],
            "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3], "uvs": [[0,0],[2,0],[2,2],[0,2]],
            "colors": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "bakedLight": )" +
           baked + "}]}";
}

std::string baked_refusal(const std::string& baked) {
    return error_of(lit_square(baked));
}

}  // namespace

TEST_CASE("what is linear on a mesh stays so when its triangles are halved for baked light",
          "[scene][baked]") {
    Draw draw(7);
    std::string splits;
    for (int i = 0; i < 40; ++i) {
        const int triangle = static_cast<int>(draw.uniform(0, 2 + i)),
                  edge = static_cast<int>(draw.uniform(0, 3));
        splits += (splits.empty() ? "" : ",") + std::to_string(triangle) + "," + std::to_string(edge);
    }
    const Scene scene =
        load_text(lit_square(R"({"triangles": 2, "colors": [], "splits": [)" + splits + "]}"));
    const ObjectMesh& mesh = scene.meshes[0].object;
    REQUIRE(mesh.triangles.size() == 42);
    REQUIRE(mesh.uvs.size() == 42);
    REQUIRE(mesh.colors.size() == 42);
    REQUIRE(mesh.material.size() == 42);
    REQUIRE(mesh.baked.size() == 42);
    double area = 0;
    for (std::size_t t = 0; t < 42; ++t) {
        const auto& corner = mesh.triangles[t];
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& at = mesh.points[corner[k]];
            CHECK(length(mesh.uvs[t][k] - 2.0 * Vec2(at.x, at.y)) < 1e-12);
            CHECK(length(Vec3(mesh.colors[t][k]) - Vec3(at.x, at.y, 0)) < 1e-12);
            CHECK(mesh.colors[t][k].w == 1);
        }
        const Vec3 normal = cross(mesh.points[corner[1]] - mesh.points[corner[0]],
                                  mesh.points[corner[2]] - mesh.points[corner[0]]);
        CHECK(normal.z > 0);  // none turns over
        area += 0.5 * normal.z;
    }
    CHECK(area == Approx(1));
}

TEST_CASE("baked light comes to the corners that its file names", "[scene][baked]") {
    const Scene scene = load_text(lit_square(
        R"({"triangles": 2, "colors": [[1,2,3],[4,5,6]], "front": [0,0,1, 1,0,0], "back": [1,1,1, 0,0,0]})"));
    const std::vector<BakedLight>& baked = scene.meshes[0].object.baked;
    REQUIRE(baked.size() == 2);
    CHECK(baked[0].front[2] == Vec3(4, 5, 6));
    CHECK(baked[1].front[0] == Vec3(4, 5, 6));
    CHECK(baked[1].front[1] == Vec3(1, 2, 3));
    CHECK(baked[0].back[0] == Vec3(4, 5, 6));
    CHECK(baked[1].back[2] == Vec3(1, 2, 3));
}

TEST_CASE("light of a mesh of as many triangles that lie elsewhere is refused", "[scene][baked]") {
    const std::string square = lit_square(R"({"triangles": 2, "colors": []})");
    const ObjectMesh mesh = load_text(square).meshes[0].object;
    const std::string record = baked_light_json({2, weighted_corners(mesh), {}, {{}, {}}}).dump();
    const auto refusal = [&](const std::string& from, const std::string& to) {
        return error_of(replaced(lit_square(record), from, to));
    };
    CHECK(refusal("[1,1,0],[0,1,0]]", "[1,1,0],[0,1.00000000000001,0]]").empty());  // as rounding has it
    CHECK(refusal("\"bakedLight\"", "\"name\": \"m\", \"bakedLight\"") != "");
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
             {"\"faceVertexIndices\": [0,1,2,3]", "\"faceVertexIndices\": [3,2,1,0]"},
             {"\"faceVertexIndices\": [0,1,2,3]", "\"faceVertexIndices\": [1,2,3,0]"},
             {"[1,1,0],[0,1,0]],", "[1,1,0],[0,1.00001,0]],"},
             {"\"bakedLight\"", "\"transform\": {\"translate\": [0,0,1]}, \"bakedLight\""},
             {"\"bakedLight\"", "\"transform\": {\"scale\": [2,2,2]}, \"bakedLight\""}}) {
        INFO(to);
        CHECK(contains(refusal(from, to),
                       "/meshes/0/bakedLight/corners: the light was baked for a mesh whose"));
    }
}

TEST_CASE("baked light that does not fit its mesh is refused with its place", "[scene][baked]") {
    const std::string place = "/meshes/0/bakedLight";
    CHECK(contains(baked_refusal(R"({"triangles": 3, "colors": []})"),
                   place + "/triangles: the light was baked"));
    CHECK(contains(baked_refusal(R"({"triangles": 2, "colors": [], "splits": [0]})"), place + "/splits"));
    CHECK(contains(baked_refusal(R"({"triangles": 2, "colors": [], "splits": [0, 0, 3, 1]})"),
                   place + "/splits/2: there is no triangle 3"));
    CHECK(
        contains(baked_refusal(R"({"triangles": 2, "colors": [], "splits": [0, 3]})"), place + "/splits/1"));
    CHECK(contains(baked_refusal(R"({"triangles": 2, "colors": [[1,1,1]], "front": [0,0,0]})"),
                   place + "/front: has 3 entries, must have 6"));
    CHECK(contains(baked_refusal(R"({"triangles": 2, "colors": [[1,1,1]], "front": [0,0,0,0,0,1]})"),
                   place + "/front/5: index 1 is out of range"));
    CHECK(contains(baked_refusal(R"({"triangles": 2, "colors": [[1,-1,1]]})"), place + "/colors/0/1"));
}
