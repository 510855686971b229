// A linear camera, one 3 x 4 map from the world to the homogeneous screen, and how a camera sees one corner
// of a grid.
#pragma once

#include "base/math/vec.h"
#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// Perspective (all rays leave `eye`) or parallel (all rays share `view_direction`), world frame.
struct LinearCamera {
    bool parallel = false;
    Vec3 eye{0};             // perspective: the centre of projection; parallel: any point of the image plane
    Vec3 view_direction{0};  // unit, the view axis; parallel: the rays' direction, whose part along the
                             // view axis is 1
    Vec4 screen_x{0}, screen_y{0},
        screen_w{0};    // rows of the map: (x w, y w, w) = rows . (point, 1); w is the depth
                        // along the view axis from `eye` for perspective, 1 for parallel
    Vec3 view_axis{0};  // of oblique cameras: unit; zero where it is view_direction

    bool operator==(const LinearCamera&) const = default;
};

/// Homogeneous screen position (x w, y w, w) of a world point; x, y in pixels from the film's top left.
/// w <= 0: the point is not in front of a perspective camera.
inline Vec3 screen_from_world(const LinearCamera& camera, const Vec3& point) {
    const Vec4 p(point, 1);
    return {dot(camera.screen_x, p), dot(camera.screen_y, p), dot(camera.screen_w, p)};
}

/// The direction from the camera to `point`: for perspective point - eye, NOT unit (the eye-to-corner
/// length); for parallel view_direction, unit but for oblique rays.
inline Vec3 incident_direction(const LinearCamera& camera, const Vec3& point) {
    if (!camera.parallel) return point - camera.eye;
    return camera.view_direction;
}

/// `screen`: homogeneous, as RayMesh::screen has it. `incident`: from the camera to the corner, not unit: the
/// eye-to-corner length, or as incident_direction for parallel rays.
struct CornerView {
    Vec3 screen{0, 0, 1};
    Vec3 incident{0};
};

}  // namespace trilens
