// One pixel explained: every ray, hit and weight behind it.
#pragma once

#include "render/request.h"
#include "render/views.h"

namespace trilens {

struct World;

/// What the centre of a pixel shows, and how.
struct PixelExplanation {
    int x = 0, y = 0;
    SampleViews views;  // of the one sample
    SampleColour colour;

    const SampleView& view() const { return views.samples.front(); }
};

/// The pixel (x, y) of the film, whatever the request's window. Throws UsageError outside of the film, and as
/// make_viewer does.
PixelExplanation explain_pixel(const World& world, const PictureRequest& request, int x, int y);

}  // namespace trilens
