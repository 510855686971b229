// What colour a sample has: the light of its direct view, or of its paths over an optic, weighted.
#pragma once

#include "render/views.h"
#include "render/world.h"

namespace trilens {

/// Shades what a sample of `views` shows.
SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view);

/// Distance from the last optic to what is seen, in scene units; the end sees something.
double path_length(const PathEnd& end);

}  // namespace trilens
