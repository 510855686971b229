// One picture of a scene, from the choice of engine to the finished image.
#pragma once

#include <functional>
#include "base/image/image.h"
#include "base/util/error.h"
#include "render/engines/engine.h"
#include "render/frame/request.h"

namespace trilens {

class MarkPainter;
struct World;

/// Draws the picture. Warns of what the user would want to know: optics off screen, pixels without a ray.
/// Throws UsageError for a window or layers that the film does not have, InputError where the film does not
/// fit the machine's memory, and as make_viewer and draw_layers do. `sink`: as draw_layers has it.
Picture draw_picture(const World& world, const PictureRequest& request, const Progress& progress,
                     const Warn& warn, const StripSink* sink = nullptr);

// From views to an image, band by band: shading, the filter, and the channels.

/// What a drawing is put into, and what is put over it; each may be null.
struct LayerOutput {
    LayerStatistics* statistics = nullptr;
    const StripSink* sink = nullptr;  // takes the pixels band by band
    const MarkPainter* marks = nullptr;
    // Told after each band how many facets are traced for want of room by now, before the band is shaded.
    std::function<void(std::size_t facets)> crowded_out = {};
};

/// Draws the window, which lies on the film and is not empty, band by band. Colours are the mean over the
/// samples of a pixel, or as the film's filter weights those around; ids, positions and depths are those of
/// the pixel's centre, whatever the number of samples. Throws Interrupted, and ComputationError when a pixel
/// is not finite. With a sink the image that comes back has no channels.
Image draw_layers(const World& world, Viewer& viewer, const LayerRequest& request, const Progress& progress,
                  const LayerOutput& output);

}  // namespace trilens
