// One picture of a scene, from the choice of engine to the finished image.
#pragma once

#include "cli/console.h"
#include "cli/layers.h"
#include "cli/views.h"

namespace trilens {

struct PictureRequest {
    std::size_t camera = 0;
    EngineChoice engine;
    LayerRequest layers;
    std::string command;  // for the header: "render" or "trace"
};

struct Picture {
    Image image;
    LayerStatistics statistics;
    double prepare_seconds = 0, draw_seconds = 0;
};

/// Draws the picture with the header fields of the interface. Says on the console what the user would want to
/// know: optics off screen, pixels without a ray.
Picture draw_picture(const World& world, const PictureRequest& request, Console& console);

}  // namespace trilens
