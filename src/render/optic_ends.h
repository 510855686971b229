// What the samples of one optic see over all its paths, drawn through the RayMesh of each history.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/facet_samples.h"
#include "paths/facet_paths.h"
#include "render/frame.h"
#include "render/views.h"
#include "render/world.h"

namespace trilens {

/// An engine's work on one RayMesh: the nearest triangles along the rays of the owned samples.
using DrawMesh = std::function<void(const RayMesh&, const FacetSamples&, const SampleGrid&, std::span<Hit>)>;

/// The ends of samples, one history after the other.
struct OpticEnds {
    std::vector<PathEnd> ends;
    std::vector<Id> sample;   // of each end
    std::vector<Step> steps;  // PathEnd::first_step counts here
};

/// Whose ends are asked for, and what draws them.
struct OpticEndsParams {
    const World& world;
    Id optic = kNone;
    const DrawMesh& draw;  // of the objects
    const FramedOptic& framed;
};

/// The ends of all samples whose first surface is the optic's, and their method, level, and what was not
/// followed. A segment ends at an object that is nearer than the next optic is, as its corners have it. Works
/// out the facets that are seen and were not before.
OpticEnds draw_optic_paths(const OpticEndsParams& params, OpticPaths& paths, const SampleGrid& grid,
                           SampleViews& views);

/// Puts the ends of all optics into the record, those of one sample side by side.
void collect_ends(const std::vector<OpticEnds>& optics, SampleViews& views);

}  // namespace trilens
