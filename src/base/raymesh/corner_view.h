// How a camera sees one corner of a grid.
#pragma once

#include "base/math/vec.h"

namespace trilens {

/// `screen`: homogeneous, as RayMesh::screen has it. `incident`: from the camera to the corner, not unit: the
/// eye-to-corner length, or as incident_direction for parallel rays.
struct CornerView {
    Vec3 screen{0, 0, 1};
    Vec3 incident{0};
};

}  // namespace trilens
