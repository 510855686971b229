// Lights out of a scene file: every kind, what is refused, and the objects that area lights show as.
#include <cmath>
#include <string>

#include "base/util/error.h"
#include "scene/animation.h"
#include "scene/load.h"
#include "support/test.h"

using namespace trilens;

namespace {

Scene lit_by(const std::string& lights, std::span<const SceneOverride> overrides = {}) {
    const std::string text = R"({"version": 1, "cameras": [{"type": "perspective", "yfov": 40,
        "lookAt": {"eye": [0, 1, 4], "at": [0, 0, 0]}}],
        "materials": [{"name": "white"}],
        "meshes": [{"name": "floor", "role": "object", "material": "white", "primitive": {"type": "plane"}}],
        "lights": )" + lights +
                             "}";
    return load_scene_text(text, SceneSource("room.json"), overrides, {});
}

std::string light_refusal(const std::string& light) {
    try {
        lit_by("[" + light + "]");
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("every kind of light is read with all of its fields", "[scene]") {
    const Scene scene = lit_by(R"([
        {"type": "directional", "direction": [0, -2, 0], "angle": 0.5, "samples": 9},
        {"type": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "innerConeAngle": 10,
         "outerConeAngle": 20},
        {"type": "rectangle", "name": "window", "position": [0, 3, 0], "direction": [0, -1, 0],
         "size": [2, 1], "up": [1, 0, 0], "color": [1, 0.5, 0], "intensity": 4},
        {"type": "disk", "position": [0, 3, 0], "direction": [0, -1, 0], "radius": 2, "visible": false},
        {"type": "sphere", "position": [0, 3, 0], "radius": 2},
        {"type": "ambient", "shadows": true, "distance": 1, "samples": 8},
        {"type": "environment"}])");
    REQUIRE(scene.lights.size() == 7);
    CHECK(std::get<DirectionalLight>(scene.lights[0].kind).angle == 0.5);
    CHECK(std::get<DirectionalLight>(scene.lights[0].kind).direction == Vec3(0, -1, 0));
    CHECK(std::get<DirectionalLight>(scene.lights[0].kind).samples == 9);
    CHECK(std::get<SpotLight>(scene.lights[1].kind).inner_cone_angle == 10);
    CHECK(std::get<SpotLight>(scene.lights[1].kind).outer_cone_angle == 20);
    CHECK(std::get<RectangleLight>(scene.lights[2].kind).size == Vec2(2, 1));
    CHECK(std::get<RectangleLight>(scene.lights[2].kind).samples == 16);
    CHECK(std::get<DiskLight>(scene.lights[3].kind).radius == 2);
    CHECK(std::get<SphereLight>(scene.lights[4].kind).position == Vec3(0, 3, 0));
    CHECK(std::get<AmbientLight>(scene.lights[5].kind).distance == 1);
    CHECK(scene.lights[5].shadows);
    CHECK(std::get<EnvironmentLight>(scene.lights[6].kind).samples == 64);

    // The window and the sphere are objects, after the floor.
    REQUIRE(scene.meshes.size() == 3);
    const Mesh& window = scene.meshes[1];
    CHECK(window.name == "window");
    CHECK(scene.materials[window.material].unlit);
    CHECK(scene.materials[window.material].base_color_factor == Vec3(4, 2, 0));
    for (const Vec3& point : window.object.points) {
        CHECK(std::fabs(point.z) == Approx(1));  // the width, across up and the direction
        CHECK(std::fabs(point.x) == Approx(0.5));
        CHECK(point.y == Approx(3));
    }
    CHECK(scene.meshes[2].name == "light4");
    for (const Vec3& point : scene.meshes[2].object.points) CHECK(length(point - Vec3(0, 3, 0)) == Approx(2));
}

TEST_CASE("lights without an area, or with fields of others, are refused by name", "[scene][bad-input]") {
    const std::string disk = R"("type": "disk", "position": [0, 3, 0], "direction": [0, -1, 0])";
    CHECK(light_refusal("{" + disk + R"(, "radius": 0})") ==
          "room.json: /lights/0/radius: 0 is out of range: must be greater than 0");
    CHECK(light_refusal("{" + disk + R"(, "samples": 0})") ==
          "room.json: /lights/0/samples: 0 is out of range: must be at least 1");
    CHECK(light_refusal("{" + disk + R"(, "size": [1, 1]})") ==
          "room.json: /lights/0/size: 'size' is no key of a disk light");
    CHECK(light_refusal(
              R"({"type": "rectangle", "position": [0, 3, 0], "direction": [0, -1, 0], "size": [1, 0]})") ==
          "room.json: /lights/0/size/1: 0 is out of range: must be greater than 0");
    CHECK(
        light_refusal(
            R"({"type": "rectangle", "position": [0, 3, 0], "direction": [0, -1, 0], "size": [1e-200, 1e-200]})") ==
        "room.json: /lights/0/size: has no area");
    CHECK(light_refusal("{" + disk + R"(, "radius": 1e-200})") == "room.json: /lights/0/radius: has no area");
    CHECK(light_refusal(R"({"type": "sphere", "position": [0, 3, 0], "radius": 1e-200})") ==
          "room.json: /lights/0/radius: has no area");
    CHECK(light_refusal(R"({"type": "rectangle", "position": [0, 3, 0], "direction": [0, 0, 0]})") ==
          "room.json: /lights/0/direction: a direction must not be zero");
    CHECK(light_refusal(
              R"({"type": "spot", "position": [0, 3, 0], "direction": [0, -1, 0], "innerConeAngle": 50})") ==
          "room.json: /lights/0/innerConeAngle: the inner cone must be within the outer one");
    CHECK(light_refusal(R"({"type": "sphere"})") == "room.json: /lights/0: a sphere light needs 'position'");
}

TEST_CASE("an animated light takes its object along", "[scene]") {
    const Scene scene = lit_by(R"([{"type": "sphere", "position": [0, 3, 0], "radius": 1}])");
    const std::vector<SceneOverride> up{{"/lights/0/position/1", "7"}};
    const Scene moved = load_frame(scene, 0, up, {});
    REQUIRE(moved.meshes.size() == 2);
    CHECK(std::get<SphereLight>(moved.lights[0].kind).position.y == 7);
    for (const Vec3& point : moved.meshes[1].object.points) CHECK(point.y > 5.9);
}
