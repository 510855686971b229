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
    // `change` takes the kind or the whole camera.
    const auto refused = [](auto kind, const std::string& field, auto change) {
        CameraDescription from;
        if constexpr (requires { change(kind, from); }) {
            change(kind, from);
        } else {
            change(kind);
        }
        from.kind = kind;
        const std::string message = refusal(from);
        INFO(message);
        CHECK(begins(message, "room.json: /cameras/0/" + field));
    };
    refused(CylindricalCamera(), "hfov", [](auto& c) { c.hfov = 361; });
    refused(CylindricalCamera(), "yfov", [](auto& c) { c.yfov = 180; });
    refused(SphericalCamera(), "lookAt", [](auto&, auto& c) { c.at = c.eye; });
    refused(SphericalCamera(), "lookAt", [](auto&, auto& c) { c.up = {0, 0, 1}; });
    refused(SphericalCamera(), "lookAt", [](auto&, auto& c) { c.eye.x = NAN; });
    refused(FisheyeCamera(), "fov", [](auto& c) { c.fov = 361; });
    refused(FisheyeCamera(), "fov", [](auto& c) {
        c.mapping = FisheyeMapping::kOrthographic;
        c.fov = 181;
    });
    refused(FisheyeCamera(), "fov", [](auto& c) {
        c.mapping = FisheyeMapping::kStereographic;
        c.fov = 360;
    });
    refused(PushbroomCamera(), "travel", [](auto& c) { c.travel = {0, 0, 1}; });
    refused(PushbroomCamera(), "travel", [](auto& c) { c.travel = Vec3(0); });
    refused(CrossedSlitsCamera(), "slits/1", [](auto& c) { c.slits[1].direction = Vec3(0); });
    refused(CrossedSlitsCamera(), "slits", [](auto& c) { c.slits[1] = c.slits[0]; });
    refused(CrossedSlitsCamera(), "window", [](auto& c) { c.window = {1, 1, 0, 1}; });
    refused(ThreeRayCamera(), "rays/0/direction", [](auto& c) { c.placed_rays[0].direction = {0, 0, 1}; });
    refused(ThreeRayCamera(), "rays", [](auto& c) {
        for (PlacedRay& ray : c.placed_rays) ray.direction = {0, 0, -1};
    });
    refused(DistortionCamera(), "detail", [](auto& c) { c.detail = {0.5, 0, 0.5, 1}; });
    refused(DistortionCamera(), "contextFov", [](auto& c) { c.context_fov = 20; });
    refused(MultiPerspectiveCamera(), "views", [](auto&) {});
    refused(InwardSphereCamera(), "radius", [](auto& c) { c.radius = 0; });
    refused(PlanarContextCamera(), "ground", [](auto& c) { c.ground_point = {0, 5, 0}; });
    refused(PlanarContextCamera(), "angle", [](auto& c, auto& camera) {
        camera.eye = {0, 1, 0};
        camera.at = {0, 1, -1};
        c.angle = 91;
    });
    refused(OpencvLens(), "fx", [](auto& c) { c.fx = 0; });
    refused(OpencvLens(), "distortion", [](auto& c) { c.distortion = {1, 2, 3}; });
    refused(SphericalCamera(), "tolerance", [](auto&, auto& c) { c.tolerance = 1e-9; });
    refused(PerspectiveCamera(), "far", [](auto& c) { c.near_depth = 2, c.far_depth = 1; });
    refused(OrthographicCamera(), "ymag", [](auto& c) { c.ymag = 0; });
}

TEST_CASE("a lens that folds the film is refused with the place", "[camera][bad-input]") {
    CameraDescription from;
    OpencvLens lens{false, 200, 200, 160, 120, {-0.9, 0, 0, 0}};
    from.kind = lens;
    const std::string message = refusal(from);
    INFO(message);
    CHECK(message.find("not one-to-one in the film") != std::string::npos);
    CHECK(message.find("pixel 0.0, 0.0") != std::string::npos);
    // The same lens on a film that ends before the fold.
    CHECK(refusal(from, {60, 40}).empty() == false);
    lens.cx = 30, lens.cy = 20;
    from.kind = lens;
    CHECK(refusal(from, {60, 40}).empty());
    from.kind = OpencvLens{true, 100, 100, 160, 120, {-0.3, 0, 0, 0}};
    CHECK(refusal(from).find("not one-to-one in the film") != std::string::npos);
}
