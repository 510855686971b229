// One picture of a scene, from the choice of engine to the finished image.
#pragma once

#include "base/image/image.h"
#include "base/util/progress.h"
#include "render/frame/request.h"

namespace trilens {

struct World;

/// Draws the picture. Warns of what the user would want to know: optics off screen, pixels without a ray.
/// Throws UsageError for a window or layers that the film does not have, InputError where the film does not
/// fit the machine's memory, and as make_viewer and draw_layers do. `sink`: as draw_layers has it.
Picture draw_picture(const World& world, const PictureRequest& request, const Progress& progress,
                     const Warn& warn, const StripSink* sink = nullptr);

}  // namespace trilens
