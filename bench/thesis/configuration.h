// A facet and a scene triangle whose shapes form a wanted configuration, and how well a picture shows them.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "trilinear/shapes.h"

namespace trilens {

/// The shapes' vertex counts, ascending: (2,2,2,3), (3,3,3), ...
using Configuration = std::vector<std::size_t>;

struct FacetScene {
    TrilinearFacet facet;
    SceneTriangle triangle;
};

/// A facet scene recut so that its facet encloses all shapes, with t > 0; world scaled to the triangle.
struct FramedScene {
    FacetScene scene;
    double score = 0;  // the smallest shape's width or twice the smallest gap, as a share of the facet's side
};

/// The configuration over the whole plane of weights and all t.
Configuration configuration_of(const FacetScene& scene);

/// How well the best frame shows the shapes, each of them and the gaps between them; 0: not at all.
/// The frame is free, because the parametric triangle's corners may be any three of its plane and t may start
/// anywhere.
double score_of(const FacetScene& scene);

/// The scene recut to its best frame.
FramedScene framed(const FacetScene& scene);

/// The facet with its rays begun at `t`: what lay before is behind the viewing plane.
TrilinearFacet begun_at(const TrilinearFacet& facet, double t);

/// The area of each shape inside the facet (weights >= 0, t >= 0), as shares of the facet's area, largest
/// first.
std::vector<double> visible_areas(const FacetScene& scene);

}  // namespace trilens
