// A plain pinhole for tests of rays.
#pragma once

#include "base/raymesh/ray_mesh.h"

namespace trilens_test {

/// The view axis along -z and unit focal length in pixels; enough for rays and order-one screens.
inline trilens::LinearCamera pinhole(const trilens::Vec3& eye) {
    using trilens::Vec3, trilens::Vec4;
    trilens::LinearCamera camera;
    camera.eye = eye;
    camera.view_direction = Vec3(0, 0, -1);
    camera.screen_x = Vec4(1, 0, 0, -eye.x);
    camera.screen_y = Vec4(0, -1, 0, eye.y);
    camera.screen_w = Vec4(0, 0, -1, eye.z);
    return camera;
}

}  // namespace trilens_test
