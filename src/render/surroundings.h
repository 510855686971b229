// What a camera stands in: glass around it.
#pragma once

#include "base/linear_camera.h"
#include "render/request.h"
#include "render/world.h"

namespace trilens {

/// Warns where the eye of a perspective camera is in a body of glass and the scene has other glass: paths
/// enter that as if they came from air. A body is one that a ray from the eye first meets from behind.
void warn_of_surroundings(const World& world, const LinearCamera& camera, const Warn& warn);

}  // namespace trilens
