// The image of a scene triangle in a facet as closed outlines: what a scanline filler or a drawing needs.
#pragma once

#include <vector>

#include "trilinear/curves.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

/// A closed polygon in the facet's weights, the last vertex joined to the first. Between its vertices t and
/// the barycentrics are not linear: t = n . (a - o) / (n . d) for the triangle's plane.
struct Outline {
    std::vector<ImageVertex> vertex;
};

struct ShapeParams {
    Curves curves = Curves::kArcs;
    Clip clip = Clip::kScene;
    int pieces = 8;           // kSlices, kTessellate: at least 1
    double tolerance = 1e-3;  // kArcs: how far a polygon may leave its curve, in weights; kUnclipped: away
                              // from the facet times the distance
};

/// The image with t >= 0. A weight belongs to it where an odd number of outlines holds it (even-odd rule over
/// all outlines of one call; with kTessellate over each piece). Outlines are in no particular orientation.
/// With a clip every vertex has weights >= 0, and vertices on the facet's border have a weight of exactly 0;
/// with kUnclipped outlines far from the facet end where t leaves view_windows. kArcs with any clip is exact
/// up to `tolerance`; the other ways approach it as `pieces` grows.
std::vector<Outline> project_triangle(const TrilinearFacet& facet, const SceneTriangle& triangle,
                                      const ShapeParams& params = {});

/// Whether the facet may image the triangle: a fast, conservative answer.
bool may_image(const TrilinearFacet& facet, const SceneTriangle& triangle);

/// Where the ray of the given weights meets the triangle's plane, for any t; none where it runs along it.
std::optional<ImageVertex> plane_hit(const TrilinearFacet& facet, const SceneTriangle& triangle,
                                     const Vec3& weights);

}  // namespace trilens
