// Laws of animations: a frame is the still scene with the interpolated values, byte for byte, whatever was
// kept of the frame before; rotations go as their formula says; what cannot be interpolated is told with its
// place.
#include "trilens/animation.h"

#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "base/util/error.h"
#include "support/test.h"
#include "trilens/image.h"
#include "trilens/render.h"
#include "trilens/scene.h"

using namespace trilens;
using namespace trilens_test;

namespace {

const std::string kMeshes = R"([
  { "name": "ball", "role": "optic", "material": "m", "resolution": 3,
    "primitive": { "type": "sphere", "center": [0, 0, 0], "radius": 0.8 } },
  { "name": "cage", "role": "optic", "material": "m", "resolution": 2, "transform": { "translate": [1.5, 0, 0] },
    "points": POINTS, "faceVertexCounts": [4, 4, 4, 4, 4, 4],
    "faceVertexIndices": [0,3,2,1, 4,5,6,7, 0,1,5,4, 2,3,7,6, 1,2,6,5, 0,4,7,3] },
  { "name": "card", "role": "object", "material": "a", "transform": { "translate": TRANSLATE, "rotate": ROTATE, "scale": [1, 1, 1] },
    "points": [[-1,-1,2],[1,-1,2],[1,1,2],[-1,1,2]], "faceVertexCounts": [4], "faceVertexIndices": [0,1,2,3] } ])";
const std::string kCube =
    "[[-0.5,-0.5,-0.5],[0.5,-0.5,-0.5],[0.5,0.5,-0.5],[-0.5,0.5,-0.5],[-0.5,-0.5,0.5],[0.5,-0.5,0.5],[0.5,0."
    "5,0.5],[-0.5,0.5,0.5]]";
const std::string kTaller =
    "[[-0.5,-1,-0.5],[0.5,-1,-0.5],[0.5,1,-0.5],[-0.5,1,-0.5],[-0.25,-1,0.5],[0.25,-1,0.5],[0.25,1,0.5],[-0."
    "25,1,0.5]]";

struct Values {
    std::string points = kCube, translate = "[0, 0, 0]", rotate = "[0, 0, 0, 1]", eye = "[0, 0.5, 6]";
    std::string yfov = "40", red = "0.9";
};

std::string scene_text(const Values& values, const std::string& tracks = "") {
    std::string meshes = kMeshes;
    const auto put = [&](const std::string& name, const std::string& value) {
        meshes.replace(meshes.find(name), name.size(), value);
    };
    put("POINTS", values.points);
    put("TRANSLATE", values.translate);
    put("ROTATE", values.rotate);
    return R"({ "version": 1, "film": { "width": 64, "height": 48 },
      "cameras": [ { "yfov": )" +
           values.yfov + R"(, "lookAt": { "eye": )" + values.eye + R"(, "at": [0, 0, 0] } } ],
      "materials": [ { "name": "m", "metallicFactor": 1 }, { "name": "a", "baseColorFactor": [)" +
           values.red + R"(, 0.3, 0.1] } ], "meshes": )" + meshes +
           R"(, "lights": [ { "type": "ambient", "color": [1, 1, 1] } ])" +
           (tracks.empty() ? "" : R"(, "animation": { "fps": 12, "tracks": [)" + tracks + "] }") + " }";
}

std::string track(const std::string& target, const std::string& keys, const std::string& more = "") {
    return R"({ "target": ")" + target + R"(", "keys": [)" + keys + "]" + more + " }";
}
std::string key(double frame, const std::string& value) {
    return R"({ "frame": )" + std::to_string(frame) + R"(, "value": )" + value + " }";
}

std::vector<unsigned char> drawn(const Renderer& renderer) {
    return encode_image(renderer.draw({}).image);
}

}  // namespace

TEST_CASE("a frame is the still scene with the values between the keys, byte for byte", "[laws][law]") {
    const std::string tracks =
        track("/meshes/2/transform/translate", key(0, "[0, 0, 0]") + "," + key(8, "[1, -2, 0.5]")) + "," +
        track("/cameras/0/yfov", key(0, "40") + "," + key(8, "44"), R"(, "interpolation": "linear")") + "," +
        track("/cameras/0/lookAt/eye", key(4, "[0, 0.5, 6]") + "," + key(8, "[1, 0.5, 6]")) + "," +
        track("/meshes/1/points", key(0, kCube) + "," + key(4, kTaller)) + "," +
        track("/materials/1/baseColorFactor", key(0, "[0.9, 0.3, 0.1]") + "," + key(8, "[0.5, 0.3, 0.1]"),
              R"(, "interpolation": "step")");
    const Scene scene = parse_scene(scene_text({}, tracks));
    const auto info = find_animation(scene);
    REQUIRE(info);
    CHECK((info->first == 0 && info->last == 8 && info->fps == 12 && info->tracks == 5));

    struct Frame {
        double frame;
        Values values;
    };
    // Worked out by hand: quarters and halves, exact in binary.
    const std::string halfway =
        "[[-0.5,-0.75,-0.5],[0.5,-0.75,-0.5],[0.5,0.75,-0.5],[-0.5,0.75,-0.5],[-0.375,-0.75,0.5],[0.375,-0."
        "75,0.5],[0.375,0.75,0.5],[-0.375,0.75,0.5]]";
    const std::vector<Frame> frames{
        {-3, {}},
        {2, {halfway, "[0.25, -0.5, 0.125]", "[0, 0, 0, 1]", "[0, 0.5, 6]", "41", "0.9"}},
        {6, {kTaller, "[0.75, -1.5, 0.375]", "[0, 0, 0, 1]", "[0.5, 0.5, 6]", "43", "0.9"}},
        {7, {kTaller, "[0.875, -1.75, 0.4375]", "[0, 0, 0, 1]", "[0.75, 0.5, 6]", "43.5", "0.9"}},
        {8, {kTaller, "[1, -2, 0.5]", "[0, 0, 0, 1]", "[1, 0.5, 6]", "44", "0.5"}},
        {20, {kTaller, "[1, -2, 0.5]", "[0, 0, 0, 1]", "[1, 0.5, 6]", "44", "0.5"}}};
    Renderer kept(scene_at_frame(scene, 3));
    for (const Frame& frame : frames) {
        INFO("frame " << frame.frame);
        const auto still = drawn(Renderer(parse_scene(scene_text(frame.values))));
        CHECK(drawn(Renderer(scene_at_frame(scene, frame.frame))) == still);
        kept.change(scene_at_frame(scene, frame.frame));
        CHECK(drawn(kept) == still);
    }
    // Without a frame the scene is as it stands, but for what its header says of the animation.
    const Image as_it_stands = Renderer(scene).draw({}).image,
                plain = Renderer(parse_scene(scene_text({}))).draw({}).image;
    CHECK(as_it_stands.find("R")->floats() == plain.find("R")->floats());
}

TEST_CASE("what does not move is kept, what does is built anew", "[laws][law][golden]") {
    const auto kept_by = [](const std::string& tracks) {
        const Scene scene = parse_scene(scene_text({}, tracks));
        Renderer renderer(scene_at_frame(scene, 0));
        renderer.draw({});
        return renderer.change(scene_at_frame(scene, 1));
    };
    const SceneReuse camera = kept_by(track("/cameras/0/yfov", key(0, "40") + "," + key(2, "50")));
    CHECK((camera.objects && camera.optics == 2));
    const SceneReuse object =
        kept_by(track("/meshes/2/transform/translate", key(0, "[0,0,0]") + "," + key(2, "[1,0,0]")));
    CHECK((!object.objects && object.optics == 2));
    const SceneReuse optic = kept_by(track("/meshes/1/points", key(0, kCube) + "," + key(2, kTaller)));
    CHECK((optic.objects && optic.optics == 1));
    const SceneReuse light = kept_by(track("/lights/0/color", key(0, "[1,1,1]") + "," + key(2, "[0,0,0]")));
    CHECK((light.objects && light.optics == 2));
}

TEST_CASE("rotations go along the shorter great arc at even speed", "[laws][law]") {
    // About one axis by a growing angle: the quaternion of the half angle, written down directly.
    const double most = 2.4, c = std::cos(0.5 * most), s = std::sin(0.5 * most);
    const auto quaternion = [](double x, double y, double z, double w) {
        char text[200];
        std::snprintf(text, sizeof text, "[%.17g, %.17g, %.17g, %.17g]", x, y, z, w);
        return std::string(text);
    };
    for (const double sign : {1.0, -1.0}) {  // q and -q are one rotation
        const std::string tracks = track(
            "/meshes/2/transform/rotate",
            key(0, "[0, 0, 0, 1]") + "," + key(10, quaternion(sign * 0.6 * s, sign * 0.8 * s, 0, sign * c)));
        const Scene scene = parse_scene(scene_text({}, tracks));
        for (const int frame : {0, 1, 4, 9, 10}) {
            const double half = 0.05 * frame * most;
            const Scene at = scene_at_frame(scene, frame),
                        still = parse_scene(scene_text(
                            {kCube, "[0, 0, 0]",
                             quaternion(0.6 * std::sin(half), 0.8 * std::sin(half), 0, std::cos(half))}));
            REQUIRE(at.meshes[2].object.points.size() == 4);
            for (std::size_t p = 0; p < 4; ++p)
                CHECK(length(at.meshes[2].object.points[p] - still.meshes[2].object.points[p]) < 1e-13);
        }
    }
}

TEST_CASE("keys of rotations may be angles, between which the turn goes as between their quaternions",
          "[laws][law]") {
    const std::string target = "/meshes/2/transform/rotate";
    const auto points = [&](const std::string& keys, int frame) {
        return scene_at_frame(parse_scene(scene_text({}, track(target, keys))), frame)
            .meshes[2]
            .object.points;
    };
    const double c = std::cos(0.25 * std::numbers::pi);
    char quaternion[100];
    std::snprintf(quaternion, sizeof quaternion, "[0, 0, %.17g, %.17g]", c, c);
    const std::string still = key(0, "[0, 0, 0, 1]") + ",", turned = still + key(10, quaternion);
    for (const char* angles : {R"({"euler": [0, 0, 90]})", R"({"axis": [0, 0, 2], "angle": 90})"})
        for (const int frame : {0, 3, 10}) {
            INFO(angles << " " << frame);
            const std::vector<Vec3> by_angles = points(still + key(10, angles), frame),
                                    by_quaternion = points(turned, frame);
            REQUIRE(by_angles.size() == 4);
            for (std::size_t p = 0; p < 4; ++p) CHECK(length(by_angles[p] - by_quaternion[p]) < 1e-13);
        }
}

TEST_CASE("smooth keys ease in and out", "[laws][law]") {
    const std::string tracks =
        track("/cameras/0/yfov", key(0, "40") + "," + key(4, "48"), R"(, "interpolation": "smooth")");
    const Scene scene = parse_scene(scene_text({}, tracks));
    for (const double frame : {0.0, 1.0, 2.0, 3.0, 4.0}) {
        const double s = frame / 4;
        CHECK(std::get<PerspectiveCamera>(scene_at_frame(scene, frame).cameras[0].kind).yfov ==
              Approx(40 + 8 * (3 * s * s - 2 * s * s * s)));
    }
}

TEST_CASE("a turntable goes once around what the camera looks at", "[laws][law]") {
    const Scene scene = parse_scene(scene_text({}));
    const Vec3 eye = scene.cameras[0].eye;
    for (int frame = 0; frame < 8; ++frame) {
        const Scene at = scene_at_frame(scene, frame, turntable(scene, 0, frame, 8));
        // In the plane of y by complex numbers: up is y.
        const double angle = 2 * 3.14159265358979323846 * frame / 8;
        const Vec3 expected(std::cos(angle) * eye.x + std::sin(angle) * eye.z, eye.y,
                            -std::sin(angle) * eye.x + std::cos(angle) * eye.z);
        CHECK(length(at.cameras[0].eye - expected) < 1e-14 * 10);
        CHECK(at.cameras[0].at == scene.cameras[0].at);
    }
    CHECK(scene_at_frame(scene, 0, turntable(scene, 0, 0, 8)).cameras[0].eye == eye);
}

TEST_CASE("a turntable turns a camera that moves from where the frame has it", "[laws][law]") {
    const Scene scene = parse_scene(
        scene_text({}, track("/cameras/0/lookAt/eye", key(0, "[0,1,8]") + "," + key(8, "[0,1,12]"))));
    for (int frame = 0; frame < 8; ++frame) {
        const CameraDescription still = scene_at_frame(scene, frame).cameras[0],
                                turned = scene_on_turntable(scene, frame, 0, 8).cameras[0];
        // About the vertical.
        const auto flat = [&](const Vec3& eye) {
            return Vec3(eye.x, 0, eye.z) - Vec3(still.at.x, 0, still.at.z);
        };
        CHECK(turned.eye.y == Approx(still.eye.y));
        CHECK(length(flat(turned.eye)) == Approx(length(flat(still.eye))));
        CHECK(dot(normalize(flat(turned.eye)), normalize(flat(still.eye))) ==
              Approx(std::cos(2 * 3.14159265358979323846 * frame / 8)).margin(1e-12));
    }
}

TEST_CASE("animations that are none are refused with their place", "[laws][bad-input][law]") {
    const auto refused = [](const std::string& tracks) -> std::string {
        try {
            parse_scene(scene_text({}, tracks), "", {}, "film.json");
        } catch (const InputError& error) {
            return error.what();
        }
        return "taken";
    };
    CHECK_THAT(refused(track("/cameras/0/yfow", key(0, "40"))),
               ContainsSubstring("film.json") && ContainsSubstring("/animation/tracks/0/target") &&
                   ContainsSubstring("names no value"));
    CHECK_THAT(refused(track("/meshes/9/points", key(0, "[]"))),
               ContainsSubstring("/animation/tracks/0/target"));
    CHECK_THAT(refused(track("/cameras/0/yfov", key(3, "40") + "," + key(3, "41"))),
               ContainsSubstring("/animation/tracks/0/keys/1/frame") &&
                   ContainsSubstring("after the key before it"));
    CHECK_THAT(refused(track("/meshes/1/points", key(0, kCube) + "," + key(4, "[[0,0,0]]"))),
               ContainsSubstring("/animation/tracks/0/keys/1/value") && ContainsSubstring("is not like"));
    CHECK_THAT(refused(track("/materials/0/name", key(0, R"("a")") + "," + key(4, R"("b")"))),
               ContainsSubstring("/animation/tracks/0/keys/0/value") && ContainsSubstring("step"));
    CHECK_THAT(refused(track("/meshes/2/transform/rotate", key(0, "[0,0,0,0]"))),
               ContainsSubstring("/animation/tracks/0/keys/0/value") && ContainsSubstring("zero"));
    CHECK_THAT(refused(track("/cameras/0/yfov", key(0, "40")) + "," + track("/cameras/0/yfov", key(0, "50"))),
               ContainsSubstring("/animation/tracks/1/target") && ContainsSubstring("already"));
    const std::string whole = "/meshes/2/transform/translate", place = key(0, "[0, 1, 5]"), x = key(0, "1");
    for (const char* part : {"/meshes/2/transform/translate/0", "/meshes/card/transform/translate/0"}) {
        CHECK_THAT(refused(track(whole, place) + "," + track(part, x)),
                   ContainsSubstring("/animation/tracks/1/target") &&
                       ContainsSubstring("is a part of " + whole + ", which an earlier track animates"));
        CHECK_THAT(
            refused(track(part, x) + "," + track(whole, place)),
            ContainsSubstring("/animation/tracks/1/target") && ContainsSubstring("holds " + whole + "/0"));
    }
    for (const char* bad : {R"({"euler": [0, 0]})", R"({"axis": [0, 0, 1]})",
                            R"({"axis": [0, 0, 0], "angle": 1})", R"({"turn": 3})", "40", R"("up")", "{}"})
        CHECK_THAT(refused(track("/meshes/2/transform/rotate", key(0, bad))),
                   ContainsSubstring("/animation/tracks/0/keys/0/value"));
    for (const char* form : {R"({"euler": [0, 0, %d]})", R"({"axis": [0, 1, 0], "angle": %d})"}) {
        const auto turn = [&](int angle) {
            char text[100];
            std::snprintf(text, sizeof text, form, angle);
            return std::string(text);
        };
        const auto turns = [&](int angle) {
            return refused(track("/meshes/2/transform/rotate", key(0, turn(0)) + "," + key(4, turn(angle))));
        };
        CHECK(turns(180) == "taken");
        CHECK_THAT(turns(360), ContainsSubstring("/animation/tracks/0/keys/1/value") &&
                                   ContainsSubstring("more than 180 degrees"));
    }
    CHECK_THAT(refused(R"({ "target": "/cameras/0/yfov", "keys": [], "easing": 1 })"),
               ContainsSubstring("/animation/tracks/0"));
    // A value that the schema does not allow is found when its frame is asked for.
    const Scene scene =
        parse_scene(scene_text({}, track("/cameras/0/yfov", key(0, "40") + "," + key(4, "220"))));
    CHECK_NOTHROW(scene_at_frame(scene, 1));
    CHECK_THROWS_AS(scene_at_frame(scene, 4), InputError);
    CHECK_THROWS_AS(scene_at_frame(scene, std::nan("")), UsageError);
}
