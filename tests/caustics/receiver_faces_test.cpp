// Flat parts of receivers.
#include "caustics/receiver_faces.h"

#include <cmath>

#include "support/test.h"

using namespace trilens;

TEST_CASE("The middle of a tilted face lies in its plane, and its rectangle holds it", "[caustics]") {
    TriangleScene scene;
    scene.points = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
    scene.triangles = {{0, 1, 2}};
    scene.object = {0};
    const ReceiverFaces faces(scene);
    REQUIRE(faces.faces().size() == 1);
    const ReceiverFace& face = faces.faces()[0];
    CHECK(std::fabs(dot(face.center - face.point, face.normal)) < 1e-12);
    CHECK(std::fabs(dot(face.along, face.normal)) < 1e-12);
    const Vec3 across = cross(face.normal, face.along);
    for (const Vec3& point : scene.points) {
        const Vec3 way = point - face.center;
        CHECK(length(way) <= face.radius * (1 + 1e-12));
        CHECK(std::fabs(dot(way, face.along)) <= face.half.x * (1 + 1e-12));
        CHECK(std::fabs(dot(way, across)) <= face.half.y * (1 + 1e-12));
    }
}
