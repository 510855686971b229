// Line drawings as plain data: what is drawn, fold curves, sheets of caustics.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "base/util/ids.h"

namespace trilens {

/// What is drawn beside the visible edges.
struct LineChoice {
    bool wire = false;   // hidden edges too
    bool folds = false;  // curves where what the optics show turns over on the film (caustic.h)
    // The surfaces in the world where neighbouring rays meet (caustic.h); with folds. All lines are then made
    // of rays that are exact at the facets' corners (`"rays": "interpolated"`), whatever the optics ask.
    bool caustics = false;
    bool facets = false;  // the edges of those facets of the optics that are seen
};

/// An edge of an optic's facet on the film, pixels from its top left. One that two seen facets share is there
/// once.
struct FacetEdge {
    Id optic = kNone;  // object id
    Vec2 from{0}, to{0};
};

/// An edge of an object (a border, crease, change of material or silhouette), as far as it is drawn: a
/// polygonal line in pixels from the film's top left, nowhere farther than kEdgeTolerance from the exact
/// arcs.
struct EdgeLine {
    std::string path;   // "direct", "reflect", "refract"
    Id optic = kNone;   // object id of the optic that shows it; kNone: the camera sees it
    Id object = kNone;  // whose edge it is
    std::vector<Vec2> points;
};

inline constexpr double kEdgeTolerance = 0.05;  // pixels

/// A polygonal line in pixels from the film's top left; closed where it ends where it began.
struct FoldCurve {
    Id object = kNone;  // on which it lies; kNone: the environment
    std::vector<Vec2> points;
    std::vector<Vec3> places;  // what is seen there: the world point, in the environment the unit direction
};

/// One sheet of the caustic of a RayMesh's rays, world frame. Each ray touches the caustic at up to two
/// places, the roots of the characteristic equation of the rays around it (camera/model/ray_spread.h); the
/// first sheet is the one that follows the ray's start when its roots are counted on through infinity: it has
/// the larger 1 / t.
struct CausticSheet {
    int sheet = 0;            // 0 or 1
    bool is_virtual = false;  // behind the rays' starts (t < 0): where their lines meet, not they themselves
    std::vector<Vec3> points;
    std::vector<IdTriple> triangles;          // of facets whose image on the sheet has an area
    std::vector<std::array<Id, 2>> segments;  // of those that it makes thin, as on a camera's slits
};

}  // namespace trilens
