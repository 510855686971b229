// A digest of what a scene's files hold: tells whether pictures of it may have changed.
#pragma once

#include <string>

#include "render/world.h"

namespace trilens {

/// 16 hexadecimal digits that change with any point, polygon, tag, texture coordinate, material or picture
/// that the scene loaded, from whichever file. What stands in the scene file itself is in Scene::resolved.
std::string world_digest(const World& world);

}  // namespace trilens
