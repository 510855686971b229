// Displacement maps: heights against closed forms, seams that stay closed, sharp edges that stay sharp, what
// is refused and what is said.
#include "scene/meshes/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>

#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// An object of a primitive or of a file, displaced or not.
Scene displaced(const std::string& shape, const std::string& displacement, const std::string& more = "",
                const std::string& file = "room.json") {
    const std::string keys = displacement.empty() ? std::string() : R"(, "displacement": )" + displacement;
    return load_text(
        kRoom, {{"/meshes/2", R"({"name": "shape", "role": "object", )" + shape + keys + more + "}"}}, file);
}

ObjectMesh object_of(const std::string& shape, const std::string& displacement,
                     const std::string& more = "") {
    return displaced(shape, displacement, more).meshes[2].object;
}

const std::string kBall =
    R"("material": "red", "primitive": {"type": "sphere", "center": [1, 2, 3], "radius": 2, "segments": 24})";
const std::string kPlane =
    R"("material": "red", "primitive": {"type": "plane", "center": [0, 0, 0], "size": [4, 4]})";

std::string even_map(double height) {
    const std::string h = std::to_string(height), colour = "[" + h + "," + h + "," + h + "]";
    return R"("map": {"pattern": "ramp", "colors": [)" + colour + "," + colour + "]}";
}

bool is_same(const ObjectMesh& a, const ObjectMesh& b) {
    return a.points == b.points && a.triangles == b.triangles && a.uvs == b.uvs && a.normals == b.normals &&
           a.material == b.material;
}

/// Edges that have not two triangles, points taken by their places.
std::size_t open_edges(const ObjectMesh& mesh) {
    using Place = std::array<double, 3>;
    std::map<std::pair<Place, Place>, int> count;
    const auto place = [&](Id p) { return Place{mesh.points[p].x, mesh.points[p].y, mesh.points[p].z}; };
    for (const IdTriple& triangle : mesh.triangles)
        for (std::size_t k = 0; k < 3; ++k) {
            Place a = place(triangle[k]), b = place(triangle[(k + 1) % 3]);
            if (a == b) continue;  // of a triangle without area
            const int way = a < b ? 1 : -1;
            if (b < a) std::swap(a, b);
            count[{a, b}] += way;
        }
    return static_cast<std::size_t>(
        std::count_if(count.begin(), count.end(), [](const auto& edge) { return edge.second != 0; }));
}

}  // namespace

TEST_CASE("a constant displacement map makes the offset surface", "[scene][law]") {
    const ObjectMesh ball = object_of(kBall, ""),
                     larger = object_of(kBall, "{" + even_map(0.25) + R"(, "scale": 2, "offset": 0.1})");
    REQUIRE(larger.points.size() == ball.points.size());
    const Vec3 center(1, 2, 3);
    for (std::size_t p = 0; p < ball.points.size(); ++p)
        CHECK(length(larger.points[p] - (center + 2.6 / 2 * (ball.points[p] - center))) < 1e-6);
    CHECK(larger.triangles == ball.triangles);
    CHECK(larger.uvs == ball.uvs);
    // Inwards, and in the mesh's own frame: a transform comes after.
    const ObjectMesh smaller = object_of(kBall, "{" + even_map(0.5) + R"(, "scale": -1})",
                                         R"(, "transform": {"scale": [3, 3, 3], "translate": [1, 0, 0]})");
    for (std::size_t p = 0; p < ball.points.size(); ++p)
        CHECK(length(smaller.points[p] -
                     (3.0 * (center + 0.75 * (ball.points[p] - center)) + Vec3(1, 0, 0))) < 1e-6);
    // A box: its corners move along their diagonals, and its edges stay sharp.
    const std::string box = R"("material": "red", "primitive": {"type": "box", "size": [2, 2, 2]})";
    const ObjectMesh cube = object_of(box, ""), moved = object_of(box, "{" + even_map(0.5) + "}");
    for (std::size_t p = 0; p < cube.points.size(); ++p)
        CHECK(length(moved.points[p] - (1 + 0.5 / std::sqrt(3.0)) * cube.points[p]) < 1e-6);
    for (std::size_t t = 0; t < cube.normals.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) CHECK(length(moved.normals[t][k] - cube.normals[t][k]) < 1e-6);
}

TEST_CASE("a displacement map of zero changes nothing, bit for bit", "[scene][law]") {
    for (const std::string& shape : {kBall, kPlane}) {
        CHECK(is_same(object_of(shape, "{" + even_map(0) + "}"), object_of(shape, "")));
        CHECK(is_same(object_of(shape, "{" + even_map(1) + R"(, "scale": 0})"), object_of(shape, "")));
        CHECK(!is_same(object_of(shape, "{" + even_map(0.001) + "}"), object_of(shape, "")));
    }
}

TEST_CASE("a plane moved by ripples has the waves' heights and normals", "[scene][law][oracle]") {
    const int n = 96;
    const ObjectMesh mesh =
        object_of(kPlane, R"({"map": {"pattern": "ripples", "count": [2, 3]}, "scale": 0.3, "subdivide": )" +
                              std::to_string(n) + "}");
    REQUIRE(mesh.triangles.size() == std::size_t(2 * n * n));
    // Waves across and down: (2 + cos + cos) / 4.
    const double ku = 2 * 2 * std::numbers::pi, kv = 3 * 2 * std::numbers::pi;
    double worst = 0, worst_normal = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 uv = mesh.uvs[t][k];
            const Vec3& point = mesh.points[mesh.triangles[t][k]];
            const double height = 0.3 * (2 + std::cos(ku * uv.x) + std::cos(kv * uv.y)) / 4;
            worst = std::max(worst, std::fabs(point.y - height));
            // The sides are 4 long; at the border the faces around a point are on one side of it.
            if (std::min({uv.x, uv.y, 1 - uv.x, 1 - uv.y}) < 1e-9) continue;
            const double du = 0.3 * ku * std::sin(ku * uv.x) / 4 / 4,
                         dv = 0.3 * kv * std::sin(kv * uv.y) / 4 / 4;
            const Vec3 along_u = normalize(Vec3(mesh.points[mesh.triangles[0][1]].x, 0, 0) -
                                           Vec3(mesh.points[mesh.triangles[0][0]].x, 0, 0));
            const double sign = along_u.x;  // of x along u; z goes against v or along it
            const Vec3 by_hand = normalize(Vec3(sign * du, 1, (point.z > 0) == (uv.y > 0.5) ? dv : -dv));
            worst_normal = std::max(worst_normal, length(mesh.normals[t][k] - by_hand));
        }
    INFO("heights " << worst << ", normals " << worst_normal);
    CHECK(worst < 1e-4);  // texels are 1/1024
    CHECK(worst_normal < 0.02);
}

TEST_CASE("a divided and displaced ball stays closed, also where the map has a step", "[scene][law]") {
    for (const char* map : {R"({"pattern": "ramp"})", R"({"pattern": "checker", "count": [5, 3]})",
                            R"({"pattern": "ramp", "transform": {"scale": [3.3, 1], "rotation": 40}})"}) {
        const std::string keys = std::string(R"({"map": )") + map + R"(, "scale": 0.4, "subdivide": 5})";
        CHECK(open_edges(object_of(kBall, "")) == 0);
        CHECK(open_edges(object_of(kBall, keys)) == 0);
    }
    // As a file without shared points: each of a cube's faces has its own.
    const std::string folder = scratch_dir("scene_displaced_soup");
    std::ofstream obj(folder + "/a.obj");
    const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                             {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : faces)
        for (const int p : face)
            obj << "v " << 0.1 * (p & 1) << " " << 0.7 * (p >> 1 & 1) << " " << 0.3 * (p >> 2) << "\n";
    obj << "vt 0 0\nvt 1 0.1\nvt 0.9 1\nvt 0.1 0.8\n";
    for (int f = 0; f < 6; ++f)
        for (int k = 0; k < 4; ++k)
            obj << (k == 0 ? "f" : "") << " " << 4 * f + k + 1 << "/" << k + 1 << (k == 3 ? "\n" : "");
    obj.close();
    const Scene scene =
        displaced(R"("file": "a.obj")", R"({"map": {"pattern": "ripples"}, "scale": 0.05, "subdivide": 7})",
                  "", folder + "/room.json");
    CHECK(scene.meshes[2].object.triangles.size() == 12 * 49);
    CHECK(open_edges(scene.meshes[2].object) == 0);
}

TEST_CASE("an optic's cage is displaced before it is subdivided", "[scene]") {
    const std::string grid =
        R"("role": "optic", "material": "chrome", "points": [[0,0,0],[1,0,0],[2,0,0],[0,1,0],[1,1,0],[2,1,0]],
        "faceVertexCounts": [4,4], "faceVertexIndices": [0,1,4,3,1,2,5,4], "uvs": [[0,0],[0.5,0],[1,0],[0,1],[0.5,1],[1,1]],
        "uvIndices": [0,1,4,3,1,2,5,4], "creaseIndices": [1,4], "creaseSharpnesses": [3])";
    const auto cage = [&](const std::string& keys) {
        return load_text(kRoom, {{"/meshes/2", "{" + grid + keys + "}"}}).meshes[2].cage;
    };
    const Cage flat = cage(""),
               moved = cage(
                   R"(, "displacement": {"map": {"pattern": "ramp", "wrapS": "clampToEdge"}, "scale": 4})");
    for (std::size_t p = 0; p < 6; ++p)
        CHECK(length(moved.points[p] - (flat.points[p] + Vec3(0, 0, 2 * flat.points[p].x))) < 0.003);
    CHECK(moved.crease_sharpnesses == flat.crease_sharpnesses);
    CHECK(moved.scheme == SubdivisionScheme::kCatmullClark);
    CHECK(error_of(kRoom,
                   {{"/meshes/2",
                     "{" + grid + R"(, "displacement": {"map": {"pattern": "ramp"}, "subdivide": 2}})"}}) ==
          "room.json: /meshes/2/displacement/subdivide: an optic's cage is subdivided after its points are "
          "moved: "
          "give a finer cage");
    // Without subdivision it is triangles, which can be divided.
    const Cage none = cage(
        R"(, "subdivisionScheme": "none", "displacement": {"map": {"pattern": "ramp"}, "subdivide": 3})");
    CHECK(none.face_vertex_counts.size() == 4 * 9);
    CHECK(error_with("/meshes/1/displacement", R"({"map": {"pattern": "ramp"}})") ==
          "room.json: /meshes/1/displacement: an optic's primitive is exact: heights move the points of a "
          "cage");
}

TEST_CASE("an MTL's disp moves the faces of its material", "[scene]") {
    const std::string folder = scratch_dir("scene_mtl_disp");
    const auto write = [&](const std::string& options) {
        std::ofstream(folder + "/a.obj")
            << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 5 0 0\nv 6 0 0\nv 6 1 0\n"
            << "vt 0 0\nusemtl raised\nf 1/1 2/1 3/1 4/1\nusemtl flat\nf 5/1 6/1 7/1\n";
        std::ofstream(folder + "/a.mtl")
            << "newmtl raised\ndisp " << options << " h.png\nnewmtl flat\nKd 1 0 0\n";
        std::ofstream(folder + "/h.png") << "white, by the reader";
    };
    const auto heights = [&](const std::string& options, const std::string& keys = "") {
        write(options);
        const Scene scene = displaced(R"("file": "a.obj")", keys, "", folder + "/room.json");
        const std::vector<Vec3>& points = scene.meshes[2].object.points;
        for (std::size_t p = 4; p < 7; ++p) CHECK(points[p].z == 0);
        for (std::size_t p = 1; p < 4; ++p) CHECK(points[p].z == points[0].z);
        return points[0].z;
    };
    CHECK(heights("") == Approx(1));
    CHECK(heights("-mm 0.5 2") == Approx(2.5));
    CHECK(heights("-mm 0.5") == Approx(1.5));
    CHECK(heights("-mm 0.5 2", R"({"scale": 10, "offset": 1})") == Approx(26));
    CHECK(heights("", R"({"scale": 3, "subdivide": 2})") == Approx(3));
    const auto refusal = [&](const std::string& options) {
        write(options);
        return error_of(kRoom, {{"/meshes/2", R"({"role": "object", "file": "a.obj"})"}},
                        folder + "/room.json");
    };
    CHECK(contains(refusal("-mm high"), "a.mtl: line 2: the -mm of material 'raised': 'high' is no number"));
    write("");
    std::ofstream(folder + "/a.mtl") << "newmtl raised\ndisp none.png\nnewmtl flat\n";
    CHECK(contains(
        error_of(kRoom, {{"/meshes/2", R"({"role": "object", "file": "a.obj"})"}}, folder + "/room.json"),
        "none.png: the picture of material 'raised' does not exist"));
}

TEST_CASE("displacements that cannot be are refused with their place", "[scene][bad-input]") {
    const auto refusal = [](const std::string& mesh) { return error_of(kRoom, {{"/meshes/2", mesh}}); };
    const std::string triangle =
        R"({"role": "object", "material": "red", "points": [[0,0,0],[1,0,0],[0,1,0]], "faceVertexCounts": [3], "faceVertexIndices": [0,1,2])";
    const std::string ball = R"({"role": "object", )" + kBall;
    CHECK(refusal(triangle + R"(, "displacement": {"map": {"pattern": "ramp"}}})") ==
          "room.json: /meshes/2/displacement: has no uv by which its displacement map could lie");
    CHECK(refusal(ball + R"(, "displacement": {}})") ==
          "room.json: /meshes/2/displacement: has no 'map', nor has a material of the mesh's file (disp of "
          "an MTL)");
    CHECK(contains(refusal(ball + R"(, "displacement": {"map": "none.exr"}})"),
                   "/meshes/2/displacement/map: "));
    CHECK(contains(refusal(ball + R"(, "displacement": {"map": {"pattern": "ramp"}, "height": 1}})"),
                   "unknown"));
    CHECK(refusal(ball + R"(, "displacement": {"map": {"pattern": "ramp"}, "subdivide": 256}})") ==
          "room.json: /meshes/2/displacement/subdivide: makes 34603008 triangles, more than 4194304");
    CHECK(refusal(ball + R"(, "displacement": {"map": {"pattern": "ramp", "scale": 2}}})") ==
          "room.json: /meshes/2/displacement/map/scale: 'scale' is of 'normalTexture'");
    CHECK(
        refusal(ball + R"(, "displacement": {"map": {"pattern": "ramp"}, "scale": 1e30, "offset": 1e30}})") ==
        "room.json: /meshes/2/displacement: moves points beyond coordinates of 1e30");
    CHECK(
        !refusal(
             R"({"role": "terrain", "material": "red", "heights": "h.exr", "size": [1,1,1], "displacement": {"map": {"pattern": "ramp"}}})")
             .empty());
}

TEST_CASE("what of a displacement map a mesh does not show is said", "[scene]") {
    const auto warnings = [](const std::string& keys) {
        std::vector<std::string> result;
        for (const std::string& warning : displaced(kBall, keys).warnings)
            if (contains(warning, "displacement")) result.push_back(warning);
        return result;
    };
    const std::string checks = R"({"map": {"pattern": "ripples", "count": [24, 12]}, "scale": 0.5)";
    REQUIRE(warnings(checks + "}").size() == 1);
    CHECK(contains(warnings(checks + "}")[0], "a larger 'subdivide' draws more of them"));
    CHECK(warnings(checks + R"(, "subdivide": 16})").empty());
    REQUIRE(warnings(R"({"map": {"pattern": "ramp", "texCoord": 1}, "scale": 0.1})").size() >= 1);
    CHECK(contains(warnings(R"({"map": {"pattern": "ramp", "texCoord": 1}, "scale": 0.1})")[0],
                   "asks for a second set of uv, of which there is none"));
}
