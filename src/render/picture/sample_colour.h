// What colour a sample has: the light of its direct view, or of its paths over an optic, weighted.
#pragma once

#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

/// Shades what samples show: colours[i] is that of views.samples[first + i]. Samples do not see each other:
/// a colour has the same bits whatever it is asked with.
void sample_colours(const World& world, const SampleViews& views, std::size_t first,
                    std::span<SampleColour> colours);

/// Shades what one sample, an element of views.samples, shows.
SampleColour sample_colour(const World& world, const SampleViews& views, const SampleView& view);

/// Distance from the last optic to what is seen, in scene units; the end sees something.
double path_length(const PathEnd& end);

}  // namespace trilens
