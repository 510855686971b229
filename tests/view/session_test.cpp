// The viewer's session: changes by JSON pointer, undo, ranges of numbers, moves of every kind of camera.
#include "view/session.h"

#include <trilens/error.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/test.h"
#include "view/camera_moves.h"
#include "view/numbers.h"

using namespace trilens;

namespace {

Session sphere_session() {
    for (const SceneExample& example : scene_examples())
        if (example.name == std::string("mirror-sphere")) {
            const Scene scene = parse_scene(example.json);
            Session session;
            session.now.scene = std::make_shared<const Json>(Json::parse(scene.resolved));
            return session;
        }
    FAIL("no example mirror-sphere");
    return {};
}

double distance(const Vec3& a, const Vec3& b) {
    return std::sqrt(dot(a - b, a - b));
}

}  // namespace

TEST_CASE("undo brings back every state, in order, and redo goes forward again", "[view]") {
    Session session = sphere_session();
    std::vector<Json> states{*session.now.scene};
    for (int i = 1; i <= 5; ++i) {
        set_value(session, "/film/width", 100 + i);
        end_gesture(session);
        states.push_back(*session.now.scene);
    }
    for (int i = 4; i >= 0; --i) {
        REQUIRE(undo(session));
        CHECK(*session.now.scene == states[static_cast<std::size_t>(i)]);
    }
    CHECK_FALSE(undo(session));
    for (int i = 1; i <= 5; ++i) {
        REQUIRE(redo(session));
        CHECK(*session.now.scene == states[static_cast<std::size_t>(i)]);
    }
    CHECK_FALSE(redo(session));
}

TEST_CASE("a drag of one slider is one step of undo, and a change forgets what was undone", "[view]") {
    Session session = sphere_session();
    const Json first = *session.now.scene;
    for (int i = 0; i < 100; ++i) set_value(session, "/cameras/0/yfov", 30 + 0.1 * i);
    CHECK(session.past.size() == 1);
    end_gesture(session);
    set_value(session, "/cameras/0/yfov", 50);
    CHECK(session.past.size() == 2);
    REQUIRE(undo(session));
    REQUIRE(undo(session));
    CHECK(*session.now.scene == first);
    set_value(session, "/film/width", 64);
    CHECK_FALSE(redo(session));
    for (int i = 0; i < 500; ++i) {
        set_value(session, "/film/width", 64 + i);
        end_gesture(session);
    }
    CHECK(session.past.size() == kMostUndoSteps);
}

TEST_CASE("pointers that are none and numbers that are none leave the scene as it is", "[view]") {
    Session session = sphere_session();
    const auto before = session.now.scene;
    for (const char* pointer :
         {"", "film", "/cameras/9/yfov", "/cameras/x", "/version/deeper", "/cameras/-1"})
        CHECK_THROWS_AS(set_value(session, pointer, 1), UsageError);
    for (const double number :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        CHECK_THROWS_AS(set_value(session, "/film/width", number), UsageError);
        CHECK_THROWS_AS(set_value(session, "/cameras/0/lookAt/eye", Json::array({0, number, 0})), UsageError);
    }
    CHECK(session.now.scene == before);
    CHECK(session.past.empty());
    set_value(session, "/render/maxDepth", 3);  // keys on the way are made
    CHECK(session.now.scene->at("render").at("maxDepth") == 3);
}

TEST_CASE("numbers of a scene have the schema's ranges", "[view]") {
    const Session session = sphere_session();
    const Json& scene = *session.now.scene;
    const NumberRange depth = number_range(scene, "/render/maxDepth");
    CHECK(depth.known);
    CHECK(depth.whole);
    CHECK(depth.least == 0);
    CHECK(depth.most == kMostDepth);
    const NumberRange yfov = number_range(scene, "/cameras/0/yfov");
    CHECK(yfov.known);
    CHECK_FALSE(yfov.whole);
    CHECK(yfov.least == 0);
    CHECK(yfov.most == 180);
    CHECK_FALSE(number_range(scene, "/nothing/here").known);
    std::size_t known = 0;
    const std::vector<std::string> numbers = scene_numbers(scene);
    for (const std::string& pointer : numbers) {
        INFO(pointer);
        const Json* value = find_value(scene, pointer);
        REQUIRE(value);
        REQUIRE(value->is_number());
        const NumberRange range = number_range(scene, pointer);
        known += range.known;
        CHECK(range.least <= value->get<double>());
        CHECK(range.most >= value->get<double>());
        const SliderSpan span = slider_span(range, value->get<double>());
        CHECK(span.least < span.most);
        CHECK(std::isfinite(span.least));
        CHECK(std::isfinite(span.most));
    }
    CHECK(known == numbers.size());
}

TEST_CASE("orbits keep the distance to the pivot and the horizon level; four right angles are none",
          "[view]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-1, 1);
    for (int round = 0; round < 200; ++round) {
        const Vec3 at(any(random), any(random), any(random)),
            eye = at + 3.0 * Vec3(any(random), any(random), any(random));
        if (distance(eye, at) < 0.1) continue;
        Json camera{{"type", "perspective"},
                    {"lookAt", {{"eye", {eye.x, eye.y, eye.z}}, {"at", {at.x, at.y, at.z}}}}};
        const CameraPose before = camera_pose(camera, 1);
        move_camera(camera, {CameraMove::Kind::kOrbit, {200 * any(random), 300 * any(random), 0}}, 1);
        const CameraPose after = camera_pose(camera, 1);
        CHECK(distance(after.eye, after.pivot) == Approx(distance(eye, at)).epsilon(1e-12));
        CHECK(distance(after.pivot, at) < 1e-12);
        CHECK(std::abs(after.right.y) < 1e-12);
        for (int turn = 0; turn < 4; ++turn) move_camera(camera, {CameraMove::Kind::kOrbit, {90, 0, 0}}, 1);
        CHECK(distance(camera_pose(camera, 1).eye, after.eye) < 1e-11);
        // Up and down again, away from the poles.
        const double up = 0.2;
        if (std::abs(dot(after.forward, after.turn_axis)) > 0.99) continue;
        move_camera(camera, {CameraMove::Kind::kOrbit, {0, up, 0}}, 1);
        CHECK(camera_pose(camera, 1).eye.y > after.eye.y);
        move_camera(camera, {CameraMove::Kind::kOrbit, {0, -up, 0}}, 1);
        CHECK(distance(camera_pose(camera, 1).eye, after.eye) < 1e-11);
        CHECK(before.distance == Approx(after.distance));
    }
}

TEST_CASE("pan, walk, look and dolly do what they say", "[view]") {
    const Json camera{{"type", "perspective"}, {"lookAt", {{"eye", {0, 0, 4}}, {"at", {0, 0, 0}}}}};
    Json panned = camera;
    move_camera(panned, {CameraMove::Kind::kPan, {0.5, 0.25, 0}}, 1);
    CHECK(distance(camera_pose(panned, 1).eye, {2, 1, 4}) < 1e-12);
    CHECK(distance(camera_pose(panned, 1).pivot, {2, 1, 0}) < 1e-12);
    Json walked = camera;
    move_camera(walked, {CameraMove::Kind::kWalk, {0, 0, 0.25}}, 1);
    CHECK(distance(camera_pose(walked, 1).eye, {0, 0, 3}) < 1e-12);
    Json nearer = camera;
    move_camera(nearer, {CameraMove::Kind::kDolly, {0.5, 0, 0}}, 1);
    CHECK(distance(camera_pose(nearer, 1).eye, {0, 0, 2}) < 1e-12);
    CHECK(distance(camera_pose(nearer, 1).pivot, {0, 0, 0}) < 1e-12);
    Json looked = camera;
    move_camera(looked, {CameraMove::Kind::kLook, {90, 0, 0}}, 1);
    CHECK(distance(camera_pose(looked, 1).eye, {0, 0, 4}) < 1e-12);
    CHECK(distance(camera_pose(looked, 1).forward, {1, 0, 0}) < 1e-12);
    move_camera(looked, {CameraMove::Kind::kLook, {0, 500, 0}}, 1);
    CHECK(camera_pose(looked, 1).forward.y == Approx(std::cos(3.14159265358979 / 180)));
    CHECK_THROWS_AS(move_camera(looked, {CameraMove::Kind::kDolly, {0, 0, 0}}, 1), UsageError);
    CHECK_THROWS_AS(move_camera(looked, {CameraMove::Kind::kPan, {std::nan(""), 0, 0}}, 1), UsageError);
}

TEST_CASE("cameras of every kind move as one rigid body", "[view]") {
    // By each example's own camera, and by one of explicit rays: all exact rays turn alike.
    const std::vector<std::string> cameras{
        R"({"type":"orthographic","lookAt":{"eye":[1,2,5],"at":[0,0.5,0]}})",
        R"({"type":"fisheye","lookAt":{"eye":[1,2,5],"at":[0,0.5,0]}})",
        R"({"type":"pushbroom","lookAt":{"eye":[1,2,5],"at":[0,0.5,0]},"travel":[1,0.5,0]})",
        R"({"type":"viewVolume","vrp":[0,0,1],"vpn":[0.2,0.1,1],"prp":[0,0,4],"window":[-1,1,-1,1],"projection":"perspective"})",
        R"({"type":"viewVolume","prp":[0,0,1],"window":[-1,1,-1,1],"projection":"perspective"})",
        R"({"type":"rayMesh","points":[[0,0,3],[0,0,3],[0,0,3],[0,0,3]],)"
        R"("directions":[[0,0,-1],[1,0,-1],[0,1,-1],[1,1,-1]],"screen":[[0,0],[1,0],[0,1],[1,1]],)"
        R"("triangles":[[0,1,2],[1,3,2]]})"};
    for (const std::string& text : cameras) {
        INFO(text);
        const Json camera = Json::parse(text);
        Json moved = camera;
        move_camera(moved, {CameraMove::Kind::kOrbit, {50, 20, 0}}, 4);
        move_camera(moved, {CameraMove::Kind::kPan, {0.3, -0.2, 0}}, 4);
        const auto rays = [](const Json& one) {
            const Scene scene = parse_scene(R"({"version":1,"cameras":[)" + one.dump() + "]}");
            const Camera made = make_camera(scene.cameras.at(0), {64, 48});
            std::vector<Ray> found;
            for (const Vec2 at : {Vec2(22, 18), Vec2(40, 20), Vec2(28, 33)})
                if (const auto ray = exact_ray(made, at)) found.push_back(*ray);
            return found;
        };
        const std::vector<Ray> before = rays(camera), after = rays(moved);
        REQUIRE(before.size() == after.size());
        REQUIRE(before.size() == 3);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                // Distances between places on the rays do not change, but their frame does.
                const auto at = [](const Ray& ray, double t) { return ray.origin + t * ray.direction; };
                for (const double t : {0.0, 2.0})
                    CHECK(distance(at(before[i], t), at(before[j], 1)) ==
                          Approx(distance(at(after[i], t), at(after[j], 1))).margin(1e-9));
            }
        CHECK(distance(before[0].direction, after[0].direction) > 0.01);
    }
}
