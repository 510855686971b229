// Samples near the outline of an optic, decided by the exact surfaces where the facets' outline is off.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "intersect/limit_tracer.h"
#include "render/engines/optic_outline.h"
#include "render/frame/facet_lookup.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

/// The outlines of a frame's optics.
struct OpticRims {
    std::vector<std::vector<OutlineEdge>> edges;       // per optic
    double limit = kAnyError;                          // pixels: how far they may be off
    std::vector<std::unique_ptr<FacetLookup>> facets;  // per optic; null where its outline is not off
    double error = 0;                                  // pixels: the most that is left
};

/// The outlines, and what deciding needs. `limit`: pixels; kAnyError: none is decided.
OpticRims make_rims(const World& world, const Frame& frame, double limit);

/// The window, and around it what the optic's surface may cover beyond its facets where it is decided.
SampleGrid window_with_rim(const OpticRims& rims, std::size_t optic, const SampleGrid& window,
                           const FilmSize& film);

struct RimParams {
    const World& world;
    const Frame& frame;
    const OpticRims& rims;
    double reach = 0;  // of the camera's rays
};

/// What a ray meets at t: a facet of an optic, or (kNone) an object.
struct MetSurface {
    Id optic = kNone, facet = kNone;
    double t = 0;
};

/// Whether two surfaces that a ray meets by their facets may come in the other order on the exact surfaces:
/// they lie apart by no more than these may stray from the facets.
bool may_change_order(const RimParams& params, const Ray& ray, const MetSurface& one,
                      const MetSurface& other);

/// What the samples of the grid near outlines that are off see first, on the exact surfaces. Those that see
/// an optic are to be traced: SampleView::traced is set, and they have a facet, but no leaf.
void decide_rims(const RimParams& params, const SampleGrid& grid, SampleViews& views);

/// Of samples that are traced those that see another optic first, on the exact surfaces, than by facets: they
/// show that one then. Else a path would start inside of a mirror that crosses the optic. Returns for each
/// where its ray meets the optic that it shows, as far as that was looked at: none for a lone optic, nor for
/// a camera that is not linear.
std::vector<std::optional<SurfaceHit>> decide_traced(const RimParams& params, const SampleGrid& grid,
                                                     std::span<const Id> samples, SampleViews& views);

}  // namespace trilens
