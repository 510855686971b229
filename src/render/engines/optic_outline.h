// Where on the film the outline of an optic's surface may lie elsewhere than that of its facets.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include "base/raymesh/sample_grid.h"
#include "render/frame/frame.h"

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

}  // namespace trilens
