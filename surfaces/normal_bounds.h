// How far normals turn where du and dv stay within their bounds.
#pragma once

#include "base/surface.h"

namespace trilens {

/// A normal_radius that follows from the bounds' middle, du_radius and dv_radius, for normals along du x dv
/// (turned to one side of it); 2 where du and dv may become parallel.
double normal_radius(const SurfaceBounds& bounds);

}  // namespace trilens
