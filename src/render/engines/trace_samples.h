// Ray traces samples on the exact surfaces: those that no facet speaks for, and the truth.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "paths/probe/path_probe.h"
#include "paths/trace/follow.h"
#include "render/engines/history_drawer.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

struct TraceSamplesParams {
    const World& world;
    Id optic = kNone;
    const PathCamera& camera;
    const SampleGrid& grid;
    double reach = 0;  // of the camera's rays
};

/// A sample, and where its ray meets the optic, where that is known.
struct TracedSample {
    Id sample = kNone;
    std::optional<SurfaceHit> met;
};

/// Appends the ends of all paths over the optic of these samples of `views`, and sets there what was not
/// followed. Where the camera is not linear their rays are its exact ones, as in the truth, not those of its
/// facets; one that passes the exact surface by shows no optic, but the object behind.
void trace_samples(const TraceSamplesParams& params, std::span<const TracedSample> samples,
                   SampleViews& views, PathEnds& out);

/// Where a sample's ray meets its optic first.
struct FirstHit {
    SurfaceHit at;
    Media around;  // what the ray starts in
};

/// Where what is found goes.
struct SamplePaths {
    OpticView& on_optic;  // its incidence, way and cut
    std::vector<PathEnd>& ends;
    std::vector<Step>& steps;
};

/// Appends the ends of all paths of a sample whose ray meets its optic (view.optic) there, with their steps.
/// `first_step` of the ends counts in `steps`. The rays that leave carry the eye-to-surface length, as corner
/// rays do.
void follow_sample(const World& world, const FirstHit& first, const SampleView& view,
                   const SamplePaths& found);

}  // namespace trilens
