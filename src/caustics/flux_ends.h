// Where a light's beams end: on objects, or out of the scene.
#pragma once

#include <vector>

#include "caustics/refined_beams.h"

namespace trilens {

/// Lumen, or watt, as the light's intensity has it.
struct FluxEnds {
    Vec3 on_objects{0};  // what ends on objects
    Vec3 away{0};        // what goes away from the scene
};

struct FluxQuery {
    const RefinedBeams& refined;  // of these beams
    const Beams& beams;
    const PathWorld& optics;
};

/// By beam. One whose corners and middles of sides do not all end alike is divided by exact rays; one in a
/// body of glass is shared out by its corners. An object that is smaller than a beam and at none of these
/// places gets nothing.
std::vector<FluxEnds> flux_ends_by_rays(const FluxQuery& query);

}  // namespace trilens
