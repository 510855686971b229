// What a world keeps when its scene changes; apart, since callers see it.
#pragma once

#include <cstddef>

namespace trilens {

/// What of a world stayed as it was when its scene changed: with it stay the trees and grids built of it.
struct SceneReuse {
    bool objects = false;    // all of them
    std::size_t optics = 0;  // how many, their surfaces, tracers and facets
};

}  // namespace trilens
