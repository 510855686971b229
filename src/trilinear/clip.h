// Outlines cut at a facet's border: on the screen, and in the scene (Vallance 2005, chapter 5).
#pragma once

#include <optional>
#include <vector>

#include "trilinear/outline.h"
#include "trilinear/shapes.h"

namespace trilens {

/// A facet and a scene triangle, with what the facet precalculates.
struct FacetAndTriangle {
    const TrilinearFacet& facet;
    const Coplanarity& cubic;
    const SceneTriangle& triangle;
};

/// A part of a shape's border: from one vertex to another, along a scene edge or (kSlice) straight.
struct Section {
    ImageVertex from, to;
    int edge = kSlice;
};

/// Whether the section lies in one slice: its image is straight, and t does not tell its points apart. So
/// does the image of a scene edge that is parallel to the parametric triangle: its two ends have one root, up
/// to rounding.
bool is_level(const Section& section);

/// The part of each shape whose weights are all >= 0. A section is a piece of a shape's border between two
/// neighbours among its vertices and the points where it crosses the facet's borders; these crossings are
/// computed in the scene (edge_sweep), those of level sections between their ends.
struct ClippedShapes {
    std::vector<std::vector<Section>> closed;  // shapes wholly inside
    std::vector<std::vector<Section>> chains;  // from border to border
    bool clean = true;  // false: a chain's end is not on the border, or a section runs along it: touching
                        // cases, which rounding confuses
};

ClippedShapes clip_in_scene(const FacetAndTriangle& pair, const std::vector<Shape>& shapes);

/// A polyline whose two ends lie on the facet's border (one weight exactly 0).
using Chain = std::vector<ImageVertex>;

/// Closes chains along the facet's border, corners included, so that the border between two neighbouring ends
/// is taken where its rays meet the triangle. Without chains: the whole border, if its rays meet the
/// triangle.
std::vector<Outline> join_along_border(const FacetAndTriangle& pair, const std::vector<Chain>& chains);

/// Cuts polygons at the facet's three edges; the inside is by the even-odd rule over all of them.
std::vector<Outline> clip_on_screen(const FacetAndTriangle& pair, std::vector<Outline> outlines);

}  // namespace trilens
