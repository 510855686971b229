// Samples on an optic that no facet speaks for: their own rays, followed on the exact surfaces.
#pragma once

#include <vector>

#include "paths/probe/path_probe.h"
#include "render/engines/history_drawer.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

struct TraceSamplesParams {
    const World& world;
    Id optic = kNone;
    const PathCamera& camera;
    const SampleGrid& grid;
};

/// Appends the ends of all paths over the optic of these samples of `views`, and sets there what was not
/// followed. Where the camera is not linear their rays are its exact ones, as in the truth, not those of its
/// facets; one that passes the exact surface by goes straight on.
void trace_samples(const TraceSamplesParams& params, const std::vector<Id>& samples, SampleViews& views,
                   PathEnds& out);

}  // namespace trilens
