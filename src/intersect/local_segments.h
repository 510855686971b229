// Segments made ready for a tree in float, many side by side.
#pragma once

#include "base/math/box.h"
#include "base/raymesh/segments.h"

namespace trilens {

/// Segments as Embree gets them: local frame, unit direction, started where they reach the scene.
struct LocalSegments {
    alignas(64) float origin[3][Segments::kMost], direction[3][Segments::kMost];
    alignas(64) float length[Segments::kMost];  // not below the true one
    Segments::Bits meets = 0;                   // those that reach the ball around the scene
    Segments::Bits unusual = 0;                 // those with steps whose squares no number holds: left alone
};

/// Brings segments into the frame whose origin is `centre` and whose unit is 1 / scale, where everything lies
/// in a ball of radius 1 about the origin. Good to the roundings that kBoxMargin has room for.
LocalSegments make_local_segments(const Segments& segments, const Vec3& centre, double scale);

/// Segments that may meet the box: all that do, and few that do not. A box that rounding must not cost
/// anything is wider by a few units in the last place of the segments' coordinates.
Segments::Bits may_meet(const Segments& segments, const Box& box);

}  // namespace trilens
