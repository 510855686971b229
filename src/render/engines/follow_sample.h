// One sample's own paths, followed on the exact surfaces.
#pragma once

#include <vector>

#include "paths/trace/follow.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

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
