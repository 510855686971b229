// A-priori error estimate: the displacement of a facet's interpolated rays, in pixels, before drawing.
#pragma once

#include <array>
#include <deque>
#include <vector>

#include "base/raymesh/ray_mesh.h"
#include "intersect/tracer.h"
#include "paths/facets/optic_paths.h"
#include "paths/probe/path_probe.h"

namespace trilens {

/// A facet's ray beside the exact one, through the same point of the film.
struct PredictedRay {
    const ProbeContext& context;
    const PathProbe& probe;   // kSeen, with its places beside
    std::size_t segment = 0;  // of the probe
    Ray ray;                  // what the facet has there, not unit
    Hit hit;                  // what it meets there first, before the next optic; unset: the environment
};

/// How far from this point of the film, in pixels, the exact paths show what the facet shows there: the miss
/// at the hit, across the exact ray, over how fast exact rays move there when the point on the surface moves
/// (mathematics, section 6). Infinity where that cannot be told: at a fold, or a border of histories.
double predicted_displacement(const PredictedRay& predicted);

/// A facet's ray beside an exact one, without places beside that.
struct EstimatedRay {
    const RayMesh& mesh;
    Id facet = kNone;
    Vec3 weights{0};  // of the corners there
    Ray exact;        // unit direction
    Hit hit;          // what the facet's ray meets there first; unset: the environment
};

/// The same by how fast the facet's own rays move there: no further exact ray is followed. Infinity at a fold
/// of the facet.
double estimated_displacement(const EstimatedRay& estimated);

// Adaptive subdivision: splits a facet until interpolated corner rays match the exact paths inside it.

/// A corner of a part of a facet.
struct PartCorner {
    Id shared = kNone;  // a number that the facet's neighbours know it by; kNone: this facet's alone
    PathProbe* probe = nullptr;
    Vec3 chord{0};  // the point on the facet's plane, world
};

/// A point between the corners of a part that was probed.
struct PartInside {
    PartCorner at;                     // never shared
    std::vector<std::size_t> segment;  // per history: of the probe's; empty where it is not seen
};

/// A leaf before it has a number.
struct FacetPart {
    std::uint8_t level = 0;
    LeafMethod method = LeafMethod::kProjected;
    bool layered = false;                // see PathLeaf
    Vec3 centre{0};                      // of kTraced: homogeneous screen position
    std::vector<PathSegment> histories;  // of kProjected: parents before children; empty: no rays
    std::vector<Id> node;                // per history: of OpticPaths::nodes, once it has one
    std::vector<Id> node_facet;          // per history: of the node's mesh
    std::array<PartCorner, 3> corners;
    std::array<std::vector<std::size_t>, 3> segment;  // per corner and history: of the corner's probe; empty
                                                      // for a corner that is turned away from the eye
    ProbeSide side = ProbeSide::kFront;               // the one that the facet shows
    double reach = 0;  // how far the surface may be from the facet's plane: the facet's longest edge
    std::vector<PartInside>
        inside;  // of kProjected: the edges' middles, opposite to the corners, and the centre
};

/// The weights of FacetPart::inside.
inline constexpr std::array<Vec3, 4> kInsideWeights{Vec3(0, 0.5, 0.5), Vec3(0.5, 0, 0.5), Vec3(0.5, 0.5, 0),
                                                    Vec3(1.0 / 3)};

/// A facet's parts as a tree: cells[0] is the facet.
struct DividedFacet {
    struct Cell {
        Id children = kNone;  // the first of four
        Id part = kNone;
    };
    std::vector<Cell> cells;
    std::vector<FacetPart> parts;
    std::deque<PathProbe> probes;  // at points that are no corners of the grid
    CutPaths cut;                  // the most at any point
    ProbeTally tally;              // of its parts
};

/// A facet to divide.
struct FacetToDivide {
    std::array<PartCorner, 3> corners;
    ProbeSide side = ProbeSide::kFront;  // that it shows
    double reach = 0;  // how far the surface may lie from the facet; 0: as far as the longest edge is long
};

/// Child k < 3 of a part keeps corner k of it, child 3 has the middles of its edges for corners, opposite to
/// its corners. Weights of a part's corners become those of the child's.
inline int child_of(const Vec3& weights) {
    for (int k = 0; k < 3; ++k)
        if (weights[k] > 0.5) return k;
    return 3;
}
inline Vec3 child_weights(const Vec3& weights, int child) {
    if (child == 3) return Vec3(1) - 2.0 * weights;
    Vec3 of_child = 2.0 * weights;
    of_child[child] -= 1;
    return of_child;
}

/// Paths this much fainter than followed at the centre are followed elsewhere, so that one that is just above
/// the limit at the centre is found there too.
inline constexpr double kFainter = 1.0 / 8;

/// False where all of the triangle lies off one side of a film of that size (pixels; its low corner at the
/// origin), or behind the eye; true else, and by a pixel more on all sides. Homogeneous screen positions: a
/// triangle may pass through the eye's plane.
bool may_reach_film(const std::array<Vec3, 3>& screen, const Vec2& film);

/// The area of a triangle of homogeneous screen positions, in square pixels: infinite where the eye's plane
/// passes through it, 0 where all of it lies behind the eye.
double screen_area(const std::array<Vec3, 3>& screen);

/// As far as the plan finds it worth it.
DividedFacet divide_facet(const ProbeContext& context, const FacetToDivide& facet, const DivideParams& params,
                          const ProbePlan& plan = {});

/// A facet that is traced, no part of it probed; by its corners' homogeneous screen positions.
DividedFacet traced_facet(const std::array<Vec3, 3>& screen);

/// A projected part divided in four, and on where their histories differ: cells[0] is the part, and has
/// children. One that is too small is a traced part instead. What the part's corners point to must live as
/// long as the result.
DividedFacet divide_part(const ProbeContext& context, const FacetPart& part, const DivideParams& params,
                         const ProbePlan& plan = {});

}  // namespace trilens
