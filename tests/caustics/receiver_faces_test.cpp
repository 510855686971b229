// Flat parts of receivers.
#include "caustics/receiver_faces.h"

#include <cmath>

#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

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

TEST_CASE(
    "A rectangle holds what lies in it, however it is turned and cut into triangles, and no other face any",
    "[caustics]") {
    Draw draw(5);
    for (int round = 0; round < 200; ++round) {
        const Vec3 corner = draw.unit(), long_way = draw.unit(), askew = draw.unit();
        const double length_along = draw.log_uniform(1e-3, 1e3), length_across = draw.log_uniform(1e-3, 1e3);
        const Vec3 along = length_along * long_way,
                   across = length_across * normalize(cross(long_way, askew));
        TriangleScene scene;
        scene.points = {corner, corner + along, corner + along + across, corner + across};
        const Id first = static_cast<Id>(round % 4), second = (first + 1) % 4, third = (first + 2) % 4,
                 fourth = (first + 3) % 4;
        scene.triangles = {IdTriple{first, second, third}, IdTriple{first, third, fourth}};
        scene.object = {0, 0};
        const ReceiverFaces faces(scene);
        REQUIRE(faces.faces().size() == 1);
        for (int i = 0; i < 20; ++i) {
            const double s = draw.uniform(0.001, 0.999), t = draw.uniform(0.001, 0.999);
            CHECK(faces.holds(0, corner + s * along + t * across));
            CHECK_FALSE(faces.holds(0, corner + (i % 2 ? 1 + s : -s) * along + t * across));
            CHECK_FALSE(faces.holds(0, corner + s * along + (i % 2 ? 1 + t : -t) * across));
        }

        scene.triangles.pop_back();
        scene.object.pop_back();
        CHECK_FALSE(ReceiverFaces(scene).holds(0, corner + 0.5 * (along + across) + 0.1 * (along - across)));
    }
}
