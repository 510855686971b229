// The thesis' choices: how curved edges are drawn, and where images are cut (Vallance 2005, chapters 4 and 5).
#pragma once

namespace trilens {

/// How curved edges between projected vertices are drawn.
enum class Curves {
    kStraight,    // as straight lines
    kSlices,      // with points at further levels of t (section 4.5.2): `pieces` parts of each edge's stretch of t
    kTessellate,  // the scene triangle as pieces^2 triangles, each straight (section 4.5.1)
    kArcs,        // along the exact conics, within `tolerance`
};

/// What of the image outside the facet is cut away.
enum class Clip {
    kUnclipped,  // nothing
    kScreen,     // the polygons, at the facet's edges (section 5.1)
    kScene,  // the scene's edges, where they cross the surfaces that the facet's edges sweep (section 5.2):
             // facets that share an edge share these points, so that pictures are continuous across them
};

}  // namespace trilens
