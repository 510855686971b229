// The shapes of a scene triangle in a facet: its projected vertices, joined (Vallance 2005, chapter 4,
// table 4.1), from the viewing plane t = 0 on (section 4.6).
#pragma once

#include <vector>

#include "base/math/roots.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

/// A stretch of t in which shapes are looked for.
struct Window {
    double begin = -kFarthestRoot, end = kFarthestRoot;
};

inline constexpr int kSlice = 3;  // beside the edges 0, 1, 2: along a slice, straight in weights

/// A corner of a shape.
struct ShapeVertex {
    ImageVertex at;
    int corner = -1;  // the scene vertex that is imaged here; -1: an edge is cut by the window's begin or end
    int edge = 0;     // what runs from here to the next vertex: the image of scene edge 0, 1 or 2, or kSlice
};

/// One connected piece of the triangle's image: a closed outline, the last vertex joined to the first. A
/// shape's inside is imaged once, and shapes do not overlap: a ray meets the triangle's plane in one point.
using Shape = std::vector<ShapeVertex>;

/// The real roots of the scene vertices' cubics: where each is imaged (section 4.1, project_vertices).
std::array<RealRoots, 3> project_vertices(const Coplanarity& facet, const SceneTriangle& triangle);

/// All shapes whose t lies in the window, over the whole plane of weights; over all t there are one to four
/// of two to nine vertices. The rule (section 4.3): along each scene edge the roots of both ends, merged and
/// sorted by t, are joined first to second, third to fourth, and so on; where the edge is cut at the window's
/// begin, that cut comes first. Where the window ends, a slice closes the outline. Left out are shapes with a
/// vertex where the parametric triangle is degenerate: let the window end before (view_windows).
std::vector<Shape> make_shapes(const Coplanarity& facet, const SceneTriangle& triangle,
                               const Window& window = {});

// Which stretches of t a facet sees of a scene triangle: from the viewing plane t = 0 on (Vallance 2005,
// section 4.6).

/// Windows that together hold every t >= 0 at which a ray with weights in [0, 1] can meet the triangle,
/// ascending. They end a share kCollapseGap before and begin that much after a t at which the parametric
/// triangle collapses (all rays meet in one line or point: a pinhole's t = 0, a focus), where images have no
/// place.
std::vector<Window> view_windows(const Coplanarity& facet, const SceneTriangle& triangle);

/// The parametric triangle has collapsed where its normal is below this share of the terms that it is the sum
/// of.
inline constexpr double kCollapsed = 1e-9;
inline constexpr double kCollapseGap = 1e-6;

}  // namespace trilens
