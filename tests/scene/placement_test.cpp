// Transforms: what they do to points, normals, fronts and primitives.
#include <random>

#include "scene/data/polygons.h"
#include "scene/info.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

double uniform(std::mt19937& random) {
    return std::uniform_real_distribution<double>(-1, 1)(random);
}
Vec3 random_vec(std::mt19937& random) {
    return {uniform(random), uniform(random), uniform(random)};
}

/// Rotation, scale of either sign from 1e-4 to 1e4 and translation.
Transform random_transform(std::mt19937& random) {
    Vec3 scale;
    for (int k = 0; k < 3; ++k) scale[k] = std::pow(10, 4 * uniform(random)) * (random() % 2 ? 1 : -1);
    return make_transform(random_vec(random), Vec4(random_vec(random), uniform(random)), scale);
}

std::string primitive_with(const std::string& primitive, const std::string& transform) {
    return R"({"name":"ball","role":"optic","material":"chrome","primitive":)" + primitive +
           R"(,"transform":)" + transform + "}";
}

}  // namespace

TEST_CASE("scale before rotate before translate", "[scene]") {
    const double half = std::sqrt(0.5);
    const Transform t = make_transform({10, 0, 0}, {0, 0, 3 * half, 3 * half},
                                       {2, 1, 1});  // a quarter turn about Z, not unit
    CHECK(length(map_point(t, {1, 1, 0}) - Vec3(9, 2, 0)) < 1e-14);
    const std::array<double, 16> columns = {2, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 3, 0, 1};
    CHECK(map_point(*make_transform(columns), {1, 1, 5}) == Vec3(2, 4, 5));
}

TEST_CASE("law: composition is one map after the other and normals stay at right angles to what they were",
          "[scene][law]") {
    std::mt19937 random(1);
    for (int i = 0; i < 300; ++i) {
        const Transform a = random_transform(random), b = random_transform(random);
        const Vec3 p = random_vec(random);
        const Vec3 at_once = map_point(compose(a, b), p), in_turn = map_point(a, map_point(b, p));
        CHECK(length(at_once - in_turn) <= 1e-12 * (1e8 + length(in_turn)));
        const Vec3 u = random_vec(random), v = random_vec(random);
        const Vec3 normal = normalize_or_zero(normal_map(a) * cross(u, v));
        CHECK(std::abs(dot(normal, normalize(a.linear * u))) < 1e-6);
        // The front stays the front: corners in the order that place() gives them have the mapped normal.
        const Vec3 placed =
            mirrors(a) ? cross(a.linear * v, a.linear * u) : cross(a.linear * u, a.linear * v);
        CHECK(dot(normalize(placed), normal) > 0.999);
        CHECK_FALSE(flattens(a));
    }
}

TEST_CASE("a mirroring transform reverses faces after their first corner", "[scene]") {
    PolygonMesh mesh;
    mesh.cage.points = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    mesh.cage.face_vertex_counts = {4};
    mesh.cage.face_vertex_indices = {0, 1, 2, 3};
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    REQUIRE(place(mesh, make_transform(Vec3(0), {0, 0, 0, 1}, {1, 1, -2})));
    CHECK(mesh.cage.face_vertex_indices == std::vector<int>{0, 3, 2, 1});
    CHECK(mesh.uvs[1] == Vec2(0, 1));
    CHECK(mesh.normals[1] == Vec3(0, 0, -1));
    const ObjectMesh object = triangulate(mesh).object;
    CHECK(object.triangles == std::vector<IdTriple>{{0, 3, 2}, {0, 2, 1}});
}

TEST_CASE("similarities and no other maps are known as such", "[scene]") {
    std::mt19937 random(2);
    for (int i = 0; i < 200; ++i) {
        const double factor = std::pow(10, 4 * uniform(random));
        const Vec4 turn(random_vec(random), uniform(random));
        const auto found =
            similarity_factor(make_transform(random_vec(random), turn, Vec3(factor, factor, -factor)));
        REQUIRE(found);
        CHECK(*found == Approx(factor));
        CHECK_FALSE(similarity_factor(make_transform(Vec3(0), turn, Vec3(factor, factor, factor * 1.0001))));
    }
}

TEST_CASE("primitives move and turn and grow", "[scene]") {
    const auto load = [](const std::string& primitive, const std::string& transform) {
        return *load_text(kRoom, {{"/meshes/1", primitive_with(primitive, transform)}}).meshes[1].primitive;
    };
    const std::string turn_x_to_y = R"({"translate":[1,2,3],"rotate":[0,0,1,1],"scale":[2,2,2]})";
    const Primitive sphere = load(R"({"type":"sphere","center":[1,0,0],"radius":3})", turn_x_to_y);
    CHECK(length(sphere.center - Vec3(1, 4, 3)) < 1e-14);
    CHECK(std::get<SpherePrimitive>(sphere.kind).radius == Approx(6));
    const Primitive plane =
        load(R"({"type":"plane","normal":[0,0,5],"tangent":[1,0,1],"size":[1,2]})", turn_x_to_y);
    CHECK(length(plane.axis - Vec3(0, 0, 1)) < 1e-14);
    CHECK(length(plane.tangent - Vec3(0, 1, 0)) < 1e-14);
    CHECK(std::get<PlanePrimitive>(plane.kind).size.y == Approx(4));
    const Primitive dish =
        load(R"({"type":"paraboloid","axis":[1,0,0],"focalLength":0.5,"radius":2})", turn_x_to_y);
    CHECK(length(dish.axis - Vec3(0, 1, 0)) < 1e-14);
    CHECK(std::get<ParaboloidPrimitive>(dish.kind).focal_length == Approx(1));
    CHECK(std::get<ParaboloidPrimitive>(dish.kind).radius == Approx(4));
    CHECK(std::abs(dot(dish.axis, dish.tangent)) < 1e-14);
    CHECK(length(dish.tangent) == Approx(1));
    const Primitive tube = load(R"({"type":"cylinder","height":3})", "{}");
    CHECK(tube.axis == Vec3(0, 1, 0));
    CHECK(tube.tangent == Vec3(1, 0, 0));
    CHECK(std::get<CylinderPrimitive>(tube.kind).height == 3);
}

TEST_CASE("what a scene holds is counted", "[scene]") {
    const SceneInfo info = make_scene_info(load_text(kRoom));
    CHECK(info.cameras == std::vector<std::string>{"main", "rays"});
    CHECK(info.objects == 1);
    CHECK(info.optics == 2);
    CHECK(info.triangles == 2);
    REQUIRE(info.meshes.size() == 3);
    CHECK(info.meshes[0].shape == "catmullClark");
    CHECK(info.meshes[0].faces == 2);
    CHECK(info.meshes[0].creases == 2);
    CHECK(info.meshes[0].material == "glass");
    CHECK(info.meshes[1].shape == "sphere");
    CHECK(info.meshes[1].bounds.high == Vec3(1));
    CHECK(info.meshes[2].triangles == 2);
    CHECK(info.bounds.low == Vec3(-4, -4, -4));
    CHECK(info.materials[0].kind == "mirror");
    CHECK(info.materials[1].kind == "glass");
    CHECK(info.materials[2].kind == "unlit");
    CHECK(info.materials[2].meshes == 1);
    CHECK(info.lights == 3);
}

TEST_CASE("rotations by angles are those of their matrices, whatever the order", "[scene][law]") {
    std::mt19937 random(7);
    const auto about = [](int k, double degrees) {
        const double a = degrees * M_PI / 180;
        const int i = (k + 1) % 3, j = (k + 2) % 3;
        Mat3 m(1);
        m[i][i] = m[j][j] = std::cos(a);
        m[i][j] = std::sin(a);
        m[j][i] = -std::sin(a);
        return m;
    };
    for (const std::string order : {"XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"}) {
        for (int i = 0; i < 50; ++i) {
            const Vec3 degrees = 400.0 * random_vec(random), p = random_vec(random);
            Vec3 turned = p;
            for (const char letter : order) turned = about(letter - 'X', degrees[letter - 'X']) * turned;
            const Transform t = make_transform(Vec3(0), quaternion_of_euler(degrees, order), Vec3(1));
            CHECK(length(map_point(t, p) - turned) < 1e-13);
        }
    }
    for (int k = 0; k < 3; ++k) {
        Vec3 axis(0);
        axis[k] = 0.01;
        const Vec3 p = random_vec(random);
        const Transform t = make_transform(Vec3(0), quaternion_about(axis, 77), Vec3(1));
        CHECK(length(map_point(t, p) - about(k, 77) * p) < 1e-14);
    }
    CHECK(length(map_point(make_transform(Vec3(0), quaternion_about({1, 2, 3}, 360), Vec3(1)), {4, 5, 6}) -
                 Vec3(4, 5, 6)) < 1e-13);
}

TEST_CASE("a scene turns by a quaternion, by angles and about an axis alike", "[scene]") {
    const auto center_of = [](const std::string& rotate) {
        const std::string mesh =
            primitive_with(R"({"type":"sphere","center":[1,0,0]})", R"({"rotate":)" + rotate + "}");
        return load_text(kRoom, {{"/meshes/2", mesh}}).meshes.back().primitive->center;
    };
    for (const char* rotate : {"[0,0,1,1]", R"({"euler":[0,0,90]})", R"({"axis":[0,0,5],"angle":90})",
                               R"({"euler":[90,0,90],"order":"ZXY"})"}) {
        INFO(rotate);
        const Vec3 expected =
            std::string(rotate).find("ZXY") == std::string::npos ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
        CHECK(length(center_of(rotate) - expected) < 1e-14);
    }
}

TEST_CASE("a mesh is fitted into a cube, after its transform", "[scene]") {
    const std::string mesh = R"({"name":"box","role":"object","points":[[0,0,0],[4,0,0],[0,2,1]],
        "faceVertexCounts":[3],"faceVertexIndices":[0,1,2],"transform":{"scale":[3,1,1]},
        "fit":{"center":[1,2,3],"size":2}})";
    const Scene scene = load_text(kRoom, {{"/meshes/2", mesh}});
    Box bounds;
    for (const Vec3& point : scene.meshes.back().object.points) bounds.include(point);
    CHECK(length(0.5 * (bounds.low + bounds.high) - Vec3(1, 2, 3)) < 1e-14);
    CHECK(length(bounds.size() - Vec3(2, 1.0 / 3, 1.0 / 6)) < 1e-14);
}
