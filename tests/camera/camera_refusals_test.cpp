// Cameras that are none: refused with the place of the field at fault.
#include <cmath>
#include <string>

#include "base/util/error.h"
#include "camera/camera.h"
#include "support/test.h"

using namespace trilens;

namespace {

std::string refusal(CameraDescription from, const FilmSize& film = {320, 240}) {
    try {
        make_camera(from, film, {"room.json", "/cameras/0"});
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

bool begins(const std::string& text, const std::string& with) {
    return text.rfind(with, 0) == 0;
}

}  // namespace

TEST_CASE("cameras that are none are refused by field", "[camera][bad-input]") {
    const auto refused = [](CameraType type, const std::string& field, auto change) {
        CameraDescription from;
        from.type = type;
        change(from);
        const std::string message = refusal(from);
        INFO(message);
        CHECK(begins(message, "room.json: /cameras/0/" + field));
    };
    refused(CameraType::kCylindrical, "hfov", [](auto& c) { c.hfov = 361; });
    refused(CameraType::kCylindrical, "yfov", [](auto& c) { c.yfov = 180; });
    refused(CameraType::kSpherical, "lookAt", [](auto& c) { c.at = c.eye; });
    refused(CameraType::kSpherical, "lookAt", [](auto& c) { c.up = {0, 0, 1}; });
    refused(CameraType::kSpherical, "lookAt", [](auto& c) { c.eye.x = NAN; });
    refused(CameraType::kFisheye, "fov", [](auto& c) { c.fov = 361; });
    refused(CameraType::kFisheye, "fov", [](auto& c) {
        c.mapping = FisheyeMapping::kOrthographic;
        c.fov = 181;
    });
    refused(CameraType::kFisheye, "fov", [](auto& c) {
        c.mapping = FisheyeMapping::kStereographic;
        c.fov = 360;
    });
    refused(CameraType::kPushbroom, "travel", [](auto& c) { c.travel = {0, 0, 1}; });
    refused(CameraType::kPushbroom, "travel", [](auto& c) { c.travel = Vec3(0); });
    refused(CameraType::kCrossedSlits, "slits/1", [](auto& c) { c.slits[1].direction = Vec3(0); });
    refused(CameraType::kCrossedSlits, "slits", [](auto& c) { c.slits[1] = c.slits[0]; });
    refused(CameraType::kCrossedSlits, "window", [](auto& c) { c.window = {1, 1, 0, 1}; });
    refused(CameraType::kGeneralLinear, "rays/0/direction", [](auto& c) {
        c.placed_rays[0].direction = {0, 0, 1};
    });
    refused(CameraType::kGeneralLinear, "rays", [](auto& c) {
        for (PlacedRay& ray : c.placed_rays) ray.direction = {0, 0, -1};
    });
    refused(CameraType::kDistortion, "detail", [](auto& c) { c.detail = {0.5, 0, 0.5, 1}; });
    refused(CameraType::kDistortion, "contextFov", [](auto& c) { c.context_fov = 20; });
    refused(CameraType::kMultiPerspective, "views", [](auto&) {});
    refused(CameraType::kInwardSphere, "radius", [](auto& c) { c.radius = 0; });
    refused(CameraType::kPlanarContext, "ground", [](auto& c) { c.ground_point = {0, 5, 0}; });
    refused(CameraType::kPlanarContext, "angle", [](auto& c) {
        c.eye = {0, 1, 0};
        c.at = {0, 1, -1};
        c.angle = 91;
    });
    refused(CameraType::kOpencv, "fx", [](auto& c) { c.lens.fx = 0; });
    refused(CameraType::kOpencv, "distortion", [](auto& c) { c.lens.distortion = {1, 2, 3}; });
    refused(CameraType::kSpherical, "tolerance", [](auto& c) { c.tolerance = 1e-9; });
    refused(CameraType::kPerspective, "far", [](auto& c) { c.near_depth = 2, c.far_depth = 1; });
    refused(CameraType::kOrthographic, "ymag", [](auto& c) { c.ymag = 0; });
}

TEST_CASE("a lens that folds the film is refused with the place", "[camera][bad-input]") {
    CameraDescription from;
    from.type = CameraType::kOpencv;
    from.lens = {false, 200, 200, 160, 120, {-0.9, 0, 0, 0}};
    const std::string message = refusal(from);
    INFO(message);
    CHECK(message.find("not one-to-one in the film") != std::string::npos);
    CHECK(message.find("pixel 0.0, 0.0") != std::string::npos);
    // The same lens on a film that ends before the fold.
    CHECK(refusal(from, {60, 40}).empty() == false);
    from.lens.cx = 30, from.lens.cy = 20;
    CHECK(refusal(from, {60, 40}).empty());
    from.lens = {true, 100, 100, 160, 120, {-0.3, 0, 0, 0}};
    CHECK(refusal(from).find("not one-to-one in the film") != std::string::npos);
}
