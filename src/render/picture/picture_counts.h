// What a picture's statistics are counted of: its pixels, band by band.
#pragma once

#include "render/engines/engine.h"
#include "render/frame/request.h"
#include "render/world/world.h"

namespace trilens {

/// Counts a pixel by what its middle shows, a sample of `middle`.
void count_pixel(const World& world, const SampleViews& middle, const SampleView& view,
                 LayerStatistics& counts);

/// Adds the counts of other pixels.
void merge_counts(const LayerStatistics& from, LayerStatistics& to);

}  // namespace trilens
