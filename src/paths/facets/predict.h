// A-priori error estimate: the displacement of a facet's interpolated rays, in pixels, before drawing.
#pragma once

#include "base/raymesh/ray_mesh.h"
#include "intersect/tracer.h"
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

}  // namespace trilens
