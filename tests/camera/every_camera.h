// One camera of every kind that is not linear, for tests over all of them.
#pragma once

#include <string>
#include <vector>

#include "base/description/camera_description.h"

namespace trilens_test {

inline std::vector<trilens::CameraDescription> every_camera() {
    using namespace trilens;
    CameraDescription base;
    base.eye = {0.3, 1.2, 4};
    base.at = {0, 0.8, 0};
    std::vector<CameraDescription> all;
    const auto add = [&](const std::string& name, auto kind, auto change) {
        CameraDescription camera = base;
        camera.name = name;
        change(kind);
        camera.kind = kind;
        all.push_back(camera);
    };
    add("cylindrical", CylindricalCamera(), [](auto& c) { c.yfov = 70; });
    add("spherical", SphericalCamera(), [](auto&) {});
    add("equidistant", FisheyeCamera(), [](auto& c) { c.fov = 200; });
    add("equisolid", FisheyeCamera(), [](auto& c) {
        c.fov = 240;
        c.mapping = FisheyeMapping::kEquisolid;
    });
    add("stereographic", FisheyeCamera(), [](auto& c) {
        c.fov = 220;
        c.mapping = FisheyeMapping::kStereographic;
    });
    add("orthographic", FisheyeCamera(), [](auto& c) {
        c.fov = 150;
        c.mapping = FisheyeMapping::kOrthographic;
    });
    add("opencv pinhole", OpencvLens(), [](auto& c) {
        c = OpencvLens{false, 210, 214, 161.3, 118.9, {-0.21, 0.06, 0.001, -0.0015, -0.008}};
    });
    add("opencv all", OpencvLens(), [](auto& c) {
        c = OpencvLens{
            false,
            230,
            224,
            155,
            123,
            {0.11, -0.05, 0.001, -0.0015, 0.01, 0.08, -0.02, 0.004, 0.002, -0.001, 0.0015, 0.001, 0.03, -0.02}};
    });
    add("opencv fisheye", OpencvLens(), [](auto& c) {
        c = OpencvLens{true, 120, 121, 160.2, 119, {0.02, -0.006, 0.001, -0.0002}};
    });
    add("pushbroom", PushbroomCamera(), [](auto& c) {
        c.yfov = 60;
        c.travel = {4, 0.3, -0.5};
    });
    add("crossedSlits", CrossedSlitsCamera(), [](auto& c) {
        c.slits[0] = {{0.2, 1.2, 4}, {0, 1, 0.1}};
        c.slits[1] = {{0, 1.4, 7}, {1, 0, 0}};
        c.window = {-2, 2, -1.5, 1.5};
    });
    add("generalLinear", ThreeRayCamera(), [](auto& c) {
        c.placed_rays[0] = {{-1, 0.5, 4}, {-0.2, 0.3, -1}, {0, 0}};
        c.placed_rays[1] = {{1, 0.6, 4}, {0.5, 0.2, -1}, {1, 0.1}};
        c.placed_rays[2] = {{0.1, -0.3, 4.2}, {0, -0.5, -1}, {0.4, 1}};
    });
    add("distortion", DistortionCamera(), [](auto& c) {
        c.detail = {0.3, 0.3, 0.75, 0.7};
        c.yfov = 25;
        c.context_fov = 170;
    });
    add("multiPerspective", MultiPerspectiveCamera(), [&](auto& c) {
        CameraDescription front = base, side = base;
        front.kind = PerspectiveCamera{.yfov = 50};
        side.kind = PerspectiveCamera{.yfov = 55};
        side.eye = {3.5, 1.5, 2.5};
        CameraDescription fish = base;
        fish.kind = FisheyeCamera{.fov = 300};
        c.views = {{front, {0, 0, 0.6, 1}}, {side, {0.6, 0, 1, 0.5}}, {fish, {0.6, 0.5, 1, 1}}};
        c.blend = 0.1;
    });
    add("inwardSphere", InwardSphereCamera(), [](auto& c) {
        c.center = {0.1, 0.8, 0.2};
        c.radius = 3;
    });
    add("planarContext", PlanarContextCamera(), [](auto& c) {
        c.yfov = 70;
        c.bend = 2.5;
        c.angle = 65;
    });
    return all;
}

}  // namespace trilens_test
