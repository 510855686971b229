// From views to an image: shading, the box filter, and the channels of the interface.
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "cli/views.h"
#include "image/image.h"

namespace trilens {

/// Colours of one sample, linear Rec.709; the three parts add up to the beauty.
struct SampleColour {
    Vec3 direct{0}, reflect{0}, refract{0};
    double coverage = 0;  // 1 where a mesh is seen, 0 on the background
};

/// Shades what a sample shows.
SampleColour shade_view(const World& world, const SampleView& view);

struct LayerRequest {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // window of the film
    std::vector<std::string> aovs;       // layer names to keep beside RGBA; empty: all
};

/// Counts of what the user would want to know.
struct LayerStatistics {
    std::size_t optic_pixels = 0;
    std::size_t pixels_without_ray = 0;  // pixels on an optic that lack a ray a path asked for
};

/// Draws the window band by band. Colours are the mean over the samples of a pixel; ids, positions and depths
/// are those of the pixel's centre, whatever the number of samples. Throws Interrupted, and ComputationError
/// when a pixel is not finite.
Image draw_layers(const World& world, const Viewer& viewer, const LayerRequest& request,
                  const Progress& progress, LayerStatistics* statistics = nullptr);

}  // namespace trilens
