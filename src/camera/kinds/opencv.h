// OpenCV's lens models as maps of the plane: from where a pinhole would show a point to where the lens does.
#pragma once

#include <optional>

#include "base/description/camera_description.h"
#include "base/math/vec.h"

namespace trilens {

/// Film place (pixels, x right, y down) of a direction in the camera's frame (x right, y down, z ahead, any
/// length). The formulas of OpenCV's documentation, "Camera Calibration and 3D Reconstruction" (pinhole:
/// k1 k2 p1 p2 k3 k4 k5 k6 s1 s2 s3 s4 tx ty) and "Fisheye camera model" (k1 k2 k3 k4). The fisheye's angle
/// goes on beyond 90 degrees. None behind a pinhole, and straight behind a fisheye.
std::optional<Vec2> opencv_project(const OpencvLens& lens, const Vec3& direction);

/// The direction (pinhole: z = 1; fisheye: unit) that the lens shows at a film place; none where the lens has
/// none there, because it is not one-to-one on the way from the middle (or its fisheye circle ends before).
/// Newton's method along the way from the principal point, so that the branch is the one of the middle.
/// `fisheye_end`: a fisheye's opencv_fisheye_end, which takes too long to find for every place.
std::optional<Vec3> opencv_unproject(const OpencvLens& lens, const Vec2& at, double fisheye_end);

/// The angle from the axis up to which the fisheye's distance from the middle grows; at most pi.
double opencv_fisheye_end(const OpencvLens& lens);

}  // namespace trilens
