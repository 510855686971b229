// Normals of points out of the faces around them, and which normals light an object.
#include "scene/meshes/vertex_normals.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "scene/data/primitive_mesh.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A cube of side 2 about the origin, fronts outwards; the face towards +z as two triangles, so that the mean
/// of triangles would lean.
PolygonMesh cube() {
    PolygonMesh mesh;
    for (const double z : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0})
            for (const double x : {-1.0, 1.0}) mesh.cage.points.emplace_back(x, y, z);
    mesh.cage.face_vertex_counts = {4, 4, 4, 4, 4, 3, 3};
    mesh.cage.face_vertex_indices = {0, 2, 3, 1, 0, 1, 5, 4, 2, 6, 7, 3, 0,
                                     4, 6, 2, 1, 3, 7, 5, 4, 5, 7, 4, 7, 6};
    return mesh;
}

double worst_cosine(const PolygonMesh& mesh, const std::vector<Vec3>& expected) {
    double worst = 1;
    for (std::size_t corner = 0; corner < mesh.normals.size(); ++corner) {
        const auto point = static_cast<std::size_t>(mesh.cage.face_vertex_indices[corner]);
        worst = std::min(worst, dot(mesh.normals[corner], expected[point]));
    }
    return worst;
}

std::vector<Vec3> directions(const std::vector<Vec3>& points) {
    std::vector<Vec3> result;
    for (const Vec3& point : points) result.push_back(normalize(point));
    return result;
}

}  // namespace

TEST_CASE("a cube's corners look along its diagonals, however its faces are cut", "[scene]") {
    PolygonMesh mesh = cube();
    add_smooth_normals(mesh);
    REQUIRE(mesh.normals.size() == mesh.cage.face_vertex_indices.size());
    CHECK(worst_cosine(mesh, directions(mesh.cage.points)) > 1 - 1e-12);
}

TEST_CASE("normals of a cut ball come to the exact ones like the square of its segments", "[scene]") {
    double last = 1;
    for (const int segments : {12, 24, 48}) {
        ObjectPrimitive ball;
        ball.segments = segments;
        PolygonMesh mesh = tessellate(ball);
        mesh.normals.clear();
        add_smooth_normals(mesh);
        // At the poles triangles meet quads, and the order is one.
        double off = 0;
        for (std::size_t corner = 0; corner < mesh.normals.size(); ++corner) {
            const Vec3 exact =
                normalize(mesh.cage.points[static_cast<std::size_t>(mesh.cage.face_vertex_indices[corner])]);
            if (std::fabs(exact.y) < 0.6) off = std::max(off, length(mesh.normals[corner] - exact));
        }
        INFO(segments << " segments: " << off << " radians");
        CHECK(off > 0);
        CHECK(off < 5.0 / (segments * segments));
        CHECK(off < 0.35 * last);
        last = off;
    }
}

TEST_CASE("points at one place count as one; scaled, turned and shuffled faces say the same", "[scene]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    PolygonMesh mesh = cube();
    for (Vec3& point : mesh.cage.points) point += 0.4 * Vec3(any(random), any(random), any(random));
    PolygonMesh apart = mesh;  // every face with points of its own
    apart.cage.points.clear();
    for (int& index : apart.cage.face_vertex_indices) {
        apart.cage.points.push_back(mesh.cage.points[static_cast<std::size_t>(index)]);
        index = static_cast<int>(apart.cage.points.size()) - 1;
    }
    PolygonMesh large = mesh;
    for (Vec3& point : large.cage.points) point *= 1e12;
    for (PolygonMesh* one : {&mesh, &apart, &large}) add_smooth_normals(*one);
    for (std::size_t corner = 0; corner < mesh.normals.size(); ++corner) {
        CHECK(length(mesh.normals[corner]) == Approx(1));
        CHECK(length(mesh.normals[corner] - apart.normals[corner]) < 1e-12);
        CHECK(length(mesh.normals[corner] - large.normals[corner]) < 1e-12);
    }
}

TEST_CASE("given normals stay, holes and faces without area take no part, what cancels has none", "[scene]") {
    PolygonMesh mesh = cube();
    mesh.normals.assign(mesh.cage.face_vertex_indices.size(), Vec3(0));
    mesh.normals[3] = Vec3(0, 5, 0);
    mesh.cage.hole_indices = {0};  // the face towards -z
    add_smooth_normals(mesh);
    CHECK(mesh.normals[3] == Vec3(0, 5, 0));
    CHECK(mesh.normals[4].z == 0);  // of point 0: the faces towards -y and -x are left

    PolygonMesh sheet;  // two faces back to back, and one without area
    sheet.cage.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
    sheet.cage.face_vertex_counts = {3, 3, 3};
    sheet.cage.face_vertex_indices = {0, 1, 2, 0, 2, 1, 0, 1, 3};
    add_smooth_normals(sheet);
    for (const Vec3& normal : sheet.normals) CHECK(normal == Vec3(0));
}

TEST_CASE("an object is lit by given normals, flat or smooth, as its shading says", "[scene][bad-input]") {
    const auto object = [](const std::string& shape, const std::string& shading) {
        return load_text(
                   R"({"version": 1, "cameras": [{"name": "main", "lookAt": {"eye": [0, 0, 4], "at": [0, 0, 0]}}],
            "materials": [{"name": "red"}], "meshes": [{"name": "thing", "role": "object", "material": "red", )" +
                   shape + shading + "}]}")
            .meshes[0]
            .object;
    };
    const std::string tent = R"("points": [[0,0,0],[1,0,0],[1,1,0],[0,1,0],[1,0,-1],[1,1,-1]],
        "faceVertexCounts": [4, 4], "faceVertexIndices": [0,1,2,3, 1,4,5,2])";
    CHECK(object(tent, "").normals.empty());
    CHECK(object(tent, R"(, "shading": "given")").normals.empty());
    CHECK(object(tent, R"(, "shading": "flat")").normals.empty());
    const ObjectMesh smooth = object(tent, R"(, "shading": "smooth")");
    REQUIRE(smooth.normals.size() == smooth.triangles.size());
    // On the ridge between +z and +x.
    for (std::size_t t = 0; t < smooth.triangles.size(); ++t)
        for (std::size_t k = 0; k < 3; ++k)
            if (smooth.points[smooth.triangles[t][k]].x == 1 && smooth.points[smooth.triangles[t][k]].z == 0)
                CHECK(length(smooth.normals[t][k] - normalize(Vec3(1, 0, 1))) < 1e-12);

    const std::string ball = R"("primitive": {"type": "sphere", "center": [0, 0, 0], "radius": 1})";
    CHECK_FALSE(object(ball, "").normals.empty());
    CHECK(object(ball, R"(, "shading": "flat")").normals.empty());
    CHECK(object(ball, R"(, "shading": "smooth")").normals == object(ball, "").normals);
    CHECK_THROWS_AS(object(ball, R"(, "shading": "gouraud")"), InputError);
    CHECK(contains(error_with("/meshes/0/shading", R"("flat")"), "/meshes/0/shading: "));
}
