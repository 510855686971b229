// Moves of a scene's camera, of any kind, as rigid motions of what its JSON says in the world frame.
#pragma once

#include <trilens/camera.h>

#include <string>

#include "terminal/libraries.h"

namespace trilens {

/// Where a camera stands and how it is turned, world frame; right, up and forward are unit and at right
/// angles.
struct CameraPose {
    Vec3 eye{0}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    Vec3 turn_axis{0, 1, 0};  // unit: what the user calls up; orbits go about it
    Vec3 pivot{0};            // what orbits go round: lookAt's `at`, else `distance` ahead
    double distance = 1;      // from eye to pivot
};

/// The pose of a camera's JSON. `distance`: to what it looks at, for cameras without a lookAt. Throws
/// InputError where it has none (a camera without an eye, direction and rays, or which looks along its up).
CameraPose camera_pose(const Json& camera, double distance);

/// Moves of a camera's JSON, in place; degrees and scene units. All but `dolly` keep every distance between
/// what the camera is made of.
struct CameraMove {
    enum class Kind { kOrbit, kPan, kDolly, kWalk, kLook };
    Kind kind = Kind::kOrbit;
    // kOrbit: degrees that the camera goes about the pivot, x counterclockwise seen against the turn axis, y
    // up. kLook: degrees that it turns to the right and up where it stands. kPan: shares of `distance` to the
    // right and up. kDolly: x, the factor of the distance to the pivot, above 0. kWalk: right, up, forward,
    // as shares of `distance`.
    Vec3 by{0};
};

/// Throws UsageError for numbers that are not finite and factors that are not positive, InputError as
/// camera_pose does. Orbits and looks stop one degree before the poles.
void move_camera(Json& camera, const CameraMove& move, double distance);

}  // namespace trilens
