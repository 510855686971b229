// Where on the film the outline of an optic's surface may lie elsewhere than that of its facets.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "intersect/limit_tracer.h"
#include "render/frame/frame.h"
#include "render/frame/views.h"
#include "render/world/world.h"

namespace trilens {

/// A stretch of the outline that an optic's facets have: an edge between one that shows its front and one
/// that shows its back, or at a border of the surface. Pixels of the film.
struct OutlineEdge {
    std::array<Vec2, 2> end;
    double off = 0;    // the surface's own outline lies within this distance, as its samples have it
    double inset = 0;  // how far the surface's lies from the edge's middle, across the edge
};

/// All stretches of the optic's outline that have an image on the film, those within it too, where it hides a
/// part of itself. Those that straight facets show exactly are not among them.
std::vector<OutlineEdge> optic_outline(const World& world, const Frame& frame, std::size_t optic);

/// What of the window's pixels lies between the two outlines, as predicted: of arcs over their chords (2/3 of
/// length times sagitta). Of stretches that are off by `limit` at most, and only where `shows` (whether the
/// film shows the optic at a place of the window, in pixels) differs between their two sides.
double outline_area(std::span<const OutlineEdge> edges, double limit, const SampleGrid& window,
                    const std::function<bool(const Vec2&)>& shows);

/// How far the surface may stray from a facet of its grid, world units, with room for what lies between the
/// samples.
double surface_stray(const Surface& surface, const SurfaceGrid& grid, Id facet);

/// Whether a stretch is off by more than `limit` pixels, with room for what lies between the samples.
bool is_off(const OutlineEdge& edge, double limit);

/// Pixels around such a stretch within which the surface's outline lies.
double outline_room(const OutlineEdge& edge);

/// Marks the samples of the grid near stretches that are off by more than `limit`: those of all others show
/// the optic as its surface does, or are off by `limit` at most. `near` has an entry for each sample of the
/// grid.
void mark_near_outline(std::span<const OutlineEdge> edges, double limit, const SampleGrid& grid,
                       std::span<char> near);

// Samples near the outline of an optic, decided by the exact surfaces where the facets' outline is off.

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
