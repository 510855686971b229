// What the samples of one optic see over all its paths, drawn through the RayMesh of each history.
#pragma once

#include <vector>

#include "paths/nested/nested_optics.h"
#include "render/engines/history_drawer.h"
#include "render/frame/frame.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

/// Whose ends are asked for, and what draws them.
struct PathEndsParams {
    const World& world;
    Id optic = kNone;
    const DrawMesh& draw;  // of the objects
    const FramedOptic& framed;
    NestedOptics* nested = nullptr;  // optics seen in it; null: none is a nested optic
    SampleGrid grid;                 // of the samples
    SampleGrid part;                 // of the grid: no sample beyond it shows the optic
};

/// The ends of all samples whose first surface is the optic's, and their method, level, and what was not
/// followed. A segment ends at an object that is nearer than the next optic is, as its corners have it; where
/// optics are nested optics, the nearest that covers the sample and that no object is nearer than is seen,
/// and so on in that one. Works out the facets that are seen and were not before. `traced`: gets the samples
/// that no facet speaks for, whose ends are still to be found; those near outlines are among them.
PathEnds draw_optic_paths(const PathEndsParams& params, PathBuilder& paths, SampleViews& views,
                          std::vector<Id>& traced);

/// The facets that have samples.
std::vector<Id> seen_facets(const FacetSamples& owned);

/// The leaf of each sample that `owned` gives to a facet of the paths, which are prepared; of others kNone.
std::vector<Id> leaves_of_samples(const OpticPaths& paths, const FacetSamples& owned, const SampleGrid& grid);

/// Puts the ends of all optics into the record, which has none, those of one sample side by side.
void collect_ends(std::vector<PathEnds> optics, SampleViews& views);

}  // namespace trilens
