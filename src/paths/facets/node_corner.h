// The corner ray of one history, made from the probe at that corner.
#pragma once

#include <limits>

#include "paths/probe/path_probe.h"

namespace trilens {

struct NodeCorner {
    Ray ray;                                                // not unit
    Vec3 screen{0};                                         // homogeneous
    double next = std::numeric_limits<double>::infinity();  // t of the next optic; infinity: none
    Vec3 weight{1};                                         // see PathSegment::weight
};

/// The first reflection: the mirrored ray as long as the eye ray, which keeps a flat mirror exact. Beyond the
/// silhouette, where there is no segment (null), the mirror law goes on.
NodeCorner first_reflection(const PathProbe& probe, const PathSegment* segment);

/// How much farther the chord lies whose weights hold: after reflections alone the one seen in the mirrors,
/// farther away by the way between them, so that flat mirrors stay exact; else 1.
double farther(const PathProbe& probe, const PathSegment& segment, bool unfolds);

/// A later segment's ray, as long as the eye ray times the ray scale and what `farther` says.
NodeCorner later_corner(const PathProbe& probe, const PathSegment& segment, double ray_scale, bool unfolds);

}  // namespace trilens
