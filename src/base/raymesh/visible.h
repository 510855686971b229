// What a ray sees, before it is known where on the triangle: which, and about how far.
#pragma once

#include <limits>

#include "base/util/ids.h"

namespace trilens {

/// The first triangle along a ray, not yet placed on it: an entry of a visibility buffer (Burns and Hunt,
/// "The Visibility Buffer", JCGT 2013).
struct Visible {
    Id triangle = kNone;  // index into TriangleScene::triangles; kNone: nothing is seen
    // Its t, in units of the ray's direction, lies between them; both infinite where nothing is seen.
    float t_low = std::numeric_limits<float>::infinity(), t_high = std::numeric_limits<float>::infinity();

    bool seen() const { return triangle != kNone; }
};

}  // namespace trilens
