// Worlds of scenes that callers made, and pictures that callers ask for: checked before they are used.
#pragma once

#include <memory>

#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens {

/// The world of a scene. Throws InputError where the scene is none (check_scene), and as make_world does.
std::unique_ptr<World> make_checked_world(Scene scene, const Warn& warn);

/// Throws UsageError for a camera, resolution or largest error that there is not, and for an engine's
/// settings that it cannot have.
void check_request(const World& world, const PictureRequest& request);

}  // namespace trilens
