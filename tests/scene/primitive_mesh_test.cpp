// Tessellated primitives: their points, normals and fronts against the formulas, their areas and volumes in
// the limit.
#include "scene/data/primitive_mesh.h"

#include <cmath>
#include <functional>
#include <random>

#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

struct Solid {
    double area = 0, volume = 0;
    double worst_turn = 1;  // least cosine between a triangle's normal and its corners'
};

/// Of the triangles; the volume by the divergence theorem, of what is closed.
Solid measure(const ObjectMesh& mesh) {
    Solid solid;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto& [a, b, c] = mesh.triangles[t];
        const Vec3 &p = mesh.points[a], &q = mesh.points[b], &r = mesh.points[c];
        const Vec3 twice = cross(q - p, r - p);
        solid.area += 0.5 * length(twice);
        solid.volume += dot(p, cross(q, r)) / 6;
        for (const Vec3& normal : mesh.normals[t])
            solid.worst_turn = std::min(solid.worst_turn, dot(normal, normalize_or_zero(twice)));
    }
    return solid;
}

ObjectPrimitive shape_of(const ObjectPrimitiveKind& kind, int segments) {
    ObjectPrimitive p;
    p.kind = kind;
    p.segments = segments;
    p.axis = normalize(Vec3(0.3, 1, -0.4));
    p.tangent = normalize(cross(p.axis, Vec3(1, 0, 0)));
    p.center = {0.2, -0.3, 0.5};
    return p;
}

}  // namespace

TEST_CASE("tessellated primitives come to the areas and volumes of the formulas, by order two",
          "[scene][law]") {
    const double r = 1.3, h = 2.2, f = 0.7;
    struct Known {
        ObjectPrimitiveKind kind;
        double area, volume;  // 0: not closed
    };
    const double bowl = 8 * M_PI * f * f / 3 * (std::pow(1 + r * r / (4 * f * f), 1.5) - 1);
    const std::vector<Known> known{
        {SpherePrimitive{r}, 4 * M_PI * r * r, 4 * M_PI * r * r * r / 3},
        {CylinderPrimitive{r, h}, 2 * M_PI * r * (r + h), M_PI * r * r * h},
        {ConePrimitive{r, h}, M_PI * r * (r + std::hypot(r, h)), M_PI * r * r * h / 3},
        {DiskPrimitive{r}, M_PI * r * r, 0},
        {ParaboloidPrimitive{r, f}, bowl, 0}};
    for (const Known& one : known) {
        INFO(kind_name(shape_of(one.kind, 3)));
        double last = 0;
        for (const int segments : {24, 48, 96}) {
            const Solid solid = measure(triangulate(tessellate(shape_of(one.kind, segments))).object);
            const double off = std::fabs(solid.area / one.area - 1);
            CHECK(off < 12.0 / (segments * segments));
            if (last > 0) CHECK(off == Approx(last / 4).epsilon(0.1));
            last = off;
            if (one.volume > 0)
                CHECK(solid.volume == Approx(one.volume).epsilon(20.0 / (segments * segments)));
            CHECK(solid.worst_turn > 1 - 30.0 / (segments * segments));
        }
    }
    const Solid box = measure(triangulate(tessellate(shape_of(BoxPrimitive{{1, 2, 3}}, 3))).object);
    CHECK(box.area == Approx(22));
    CHECK(box.volume == Approx(6));
    CHECK(box.worst_turn == Approx(1));
    const Solid plane = measure(triangulate(tessellate(shape_of(PlanePrimitive{{1, 2}}, 3))).object);
    CHECK(plane.area == Approx(2));
    CHECK(plane.worst_turn == Approx(1));
}

TEST_CASE("points and normals of tessellated spheres and cylinders are exact, uvs turn once around",
          "[scene]") {
    const double radius = 1.3;
    const ObjectPrimitive ball = shape_of(SpherePrimitive{radius}, 17);
    const PolygonMesh mesh = tessellate(ball);
    CHECK(mesh.uvs.size() == mesh.cage.face_vertex_indices.size());
    for (std::size_t i = 0; i < mesh.cage.face_vertex_indices.size(); ++i) {
        const Vec3 from =
            mesh.cage.points[static_cast<std::size_t>(mesh.cage.face_vertex_indices[i])] - ball.center;
        CHECK(length(from) == Approx(radius).epsilon(1e-14));
        CHECK(length(mesh.normals[i] - from / radius) < 1e-14);
        CHECK(mesh.uvs[i].y ==
              Approx(0.5 + std::asin(std::clamp(dot(from, ball.axis) / radius, -1.0, 1.0)) / M_PI)
                  .margin(1e-7));
    }
}

TEST_CASE("an object may be a primitive, under any transform", "[scene]") {
    const Scene scene = load_text(kRoom, {{"/meshes/2", R"({"name":"egg","role":"object","material":"red",
                                  "primitive":{"type":"sphere","segments":32,"center":[1,0,0]},
                                  "transform":{"scale":[1,3,1]},"fit":{"center":[0,5,0],"size":6}})"}});
    const ObjectMesh& egg = scene.meshes[2].object;
    CHECK(egg.triangles.size() == 32 * 2 * 15);
    for (std::size_t t = 0; t < egg.triangles.size(); ++t) {
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p = egg.points[egg.triangles[t][k]] - Vec3(0, 5, 0);
            CHECK(p.x * p.x + p.y * p.y / 9 + p.z * p.z == Approx(1).epsilon(1e-12));
            CHECK(length(egg.normals[t][k] - normalize(Vec3(p.x, p.y / 9, p.z))) < 1e-12);
        }
    }
}
