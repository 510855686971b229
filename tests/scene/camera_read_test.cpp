// Cameras of every type out of scene files: what is read, and what is refused with its place.
#include <algorithm>
#include <fstream>
#include <sstream>

#include "json/kinds.h"
#include "scene/info.h"
#include "scene_text.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::string with_camera(const std::string& camera) {
    return R"({ "version": 1, "cameras": [)" + camera + "] }";
}

const std::string kLookAt = R"("lookAt": { "eye": [0,1,4], "at": [0,0,0] })";

CameraDescription camera_of(const std::string& camera) {
    return load_text(with_camera(camera)).cameras.at(0);
}

template <typename Kind>
Kind kind_of(const std::string& camera) {
    return std::get<Kind>(camera_of(camera).kind);
}

std::string camera_refusal(const std::string& camera) {
    return error_of(with_camera(camera));
}

}  // namespace

TEST_CASE("cameras of the shipped scene are read with their types", "[scene]") {
    std::ifstream in(source_dir() + "/scenes/cameras.json");
    std::stringstream text;
    text << in.rdbuf();
    const Scene scene = load_text(text.str());
    const SceneInfo info = make_scene_info(scene);
    REQUIRE(info.camera_types.size() == scene.cameras.size());
    CHECK(info.camera_types[1] == "fisheye");
    CHECK(info.cameras[1] == "fisheye");
    std::size_t of_types = 0;
    const std::vector<std::string> types = kind_names<CameraKind>();
    for (const std::string& type : types)
        of_types += std::count(info.camera_types.begin(), info.camera_types.end(), type) > 0;
    CHECK(of_types == types.size() - 2);  // but planarContext and rayMesh
    const auto& several = std::get<MultiPerspectiveCamera>(scene.cameras[13].kind);
    REQUIRE(several.views.size() == 3);
    CHECK(std::get<PerspectiveCamera>(several.views[1].camera.kind).yfov == 50);
    CHECK(several.views[1].window == std::array<double, 4>{0.3, 0, 0.7, 1});
}

TEST_CASE("every field of a camera arrives", "[scene]") {
    const auto shifted = kind_of<PerspectiveCamera>(
        R"({ "yfov": 50, "shift": [0.5, -1], "near": 0.1, "far": 9, )" + kLookAt + "}");
    CHECK(shifted.yfov == 50);
    CHECK(shifted.shift == Vec2(0.5, -1));
    CHECK(shifted.near_depth == 0.1);
    CHECK(shifted.far_depth == 9);
    const auto oblique = kind_of<ObliqueCamera>(
        R"({ "type": "oblique", "ymag": 3, "angle": 30, "scale": 0.5, )" + kLookAt + "}");
    CHECK(oblique.ymag == 3);
    CHECK(oblique.angle == 30);
    CHECK(oblique.scale == 0.5);
    const auto volume = kind_of<ViewVolume>(
        R"({ "type": "viewVolume", "vrp": [1,2,3], "vpn": [0,1,1], "vup": [1,0,0], "prp": [4,5,6],
             "window": [-1,2,-3,4], "projection": "parallel", "front": 1, "back": -2 })");
    CHECK(volume.vrp == Vec3(1, 2, 3));
    CHECK(volume.vpn == Vec3(0, 1, 1));
    CHECK(volume.vup == Vec3(1, 0, 0));
    CHECK(volume.prp == Vec3(4, 5, 6));
    CHECK(volume.window == std::array<double, 4>{-1, 2, -3, 4});
    CHECK(volume.parallel);
    CHECK(volume.front == 1);
    CHECK(volume.back == -2);
    const auto lens = kind_of<OpencvLens>(
        R"({ "type": "opencv", "model": "fisheye", "fx": 1, "fy": 2, "cx": 3, "cy": 4, "distortion": [0.1, 0.2, 0.3, 0.4], )" +
        kLookAt + "}");
    CHECK(lens.fisheye);
    CHECK(lens.fy == 2);
    CHECK(lens.cy == 4);
    CHECK(lens.distortion == std::vector<double>{0.1, 0.2, 0.3, 0.4});
    const CameraDescription slits = camera_of(
        R"({ "type": "crossedSlits", "slits": [[[1,2,3],[0,1,0]],[[4,5,6],[1,0,0]]], "window": [-1,1,-2,2], "facets": 7, )" +
        kLookAt + "}");
    const auto& slits_of = std::get<CrossedSlitsCamera>(slits.kind);
    CHECK(slits_of.slits[1].point == Vec3(4, 5, 6));
    CHECK(slits_of.slits[0].direction == Vec3(0, 1, 0));
    CHECK(slits_of.window == std::array<double, 4>{-1, 1, -2, 2});
    CHECK(slits.facets == 7);
    const CameraDescription bent = camera_of(
        R"({ "type": "planarContext", "ground": [[1,2,3],[0,2,0]], "bend": 5, "angle": 60, "tolerance": 0.5, )" +
        kLookAt + "}");
    const auto& ground = std::get<PlanarContextCamera>(bent.kind);
    CHECK(ground.ground_point == Vec3(1, 2, 3));
    CHECK(ground.ground_normal == Vec3(0, 2, 0));
    CHECK(ground.bend == 5);
    CHECK(bent.tolerance == 0.5);
    const auto views = kind_of<MultiPerspectiveCamera>(
        R"({ "type": "multiPerspective", "blend": 0.2, "views": [ { "window": [0,0,1,1], "type": "fisheye", "mapping": "equisolid" } ], )" +
        kLookAt + "}");
    CHECK(views.views.at(0).camera.eye == Vec3(0, 1, 4));  // the camera's own
    CHECK(std::get<FisheyeCamera>(views.views[0].camera.kind).mapping == FisheyeMapping::kEquisolid);
}

TEST_CASE("camera fields that do not belong, lack or make no sense are refused with their place",
          "[scene][bad-input]") {
    const auto check = [](const std::string& camera, const std::string& message) {
        const std::string found = camera_refusal(camera);
        INFO(camera);
        CHECK(found == "room.json: /cameras/0" + message);
    };
    check(R"({ "type": "fisheye", "yfov": 40, )" + kLookAt + "}",
          "/yfov: 'yfov' is no key of a fisheye camera");
    check(R"({ "type": "fisheye" })", ": a fisheye camera needs 'lookAt'");
    check(R"({ "shift": [1, 2], "facets": 4, )" + kLookAt + "}",
          "/facets: 'facets' is no key of a perspective camera");
    check(R"({ "type": "fisheye", "fov": 361, )" + kLookAt + "}",
          "/fov: 361 is out of range: must be at most 360");
    check(R"({ "type": "fisheye", "mapping": "equisoild", )" + kLookAt + "}",
          "/mapping: unknown value 'equisoild'; did you mean 'equisolid'?");
    check(R"({ "type": "fisheye", "facets": 4, "tolerance": 1, )" + kLookAt + "}",
          "/tolerance: stands beside facets: only one of them may be given");
    check(R"({ "type": "fisheye", "facets": 1025, )" + kLookAt + "}",
          "/facets: 1025 is out of range: must be at most 1024");
    check(R"({ "type": "viewVolume", "prp": [0,0,1], "window": [0,1,0,1] })",
          ": a viewVolume camera needs 'projection'");
    check(
        R"({ "type": "crossedSlits", "slits": [[[0,0,0],[0,0,0]],[[0,0,1],[1,0,0]]], "window": [0,1,0,1], )" +
            kLookAt + "}",
        "/slits/0/1: a direction must not be zero");
    check(R"({ "type": "planarContext", "ground": [[0,0,0],[0,0,0]], "bend": 1, )" + kLookAt + "}",
          "/ground/1: a direction must not be zero");
    check(R"({ "type": "multiPerspective", "views": [ { "yfov": 40 } ], )" + kLookAt + "}",
          "/views/0: a view needs 'window'");
    check(R"({ "type": "multiPerspective", "views": [ { "window": [0,0,1,1] } ] })",
          "/views/0: needs 'lookAt', since the camera has none");
    check(R"({ "type": "multiPerspective", "views": [ { "window": [0,0,1,1], "type": "rayMesh" } ], )" +
              kLookAt + "}",
          "/views/0/type: unknown value 'rayMesh'; known: perspective, orthographic, oblique, cylindrical, "
          "spherical, fisheye, opencv, pushbroom, generalLinear, distortion, inwardSphere, planarContext");
}
