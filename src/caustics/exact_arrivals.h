// Light that arrives at a point by exact paths: beams are where Newton's method begins.
#pragma once

#include <optional>

#include "caustics/beams/light_paths.h"
#include "caustics/footprint.h"

namespace trilens {

/// A path that meets a receiver's point to rounding.
struct ExactArrival {
    Vec2 place{0};  // on the light's window
    Ray from;       // its ray there
    SinglePath single;
    double density = 0;  // of the light's film per world area of the receiver's plane
};

/// One window's exact paths of one history.
struct ExactMap {
    const LightSpace& space;
    const BeamSource& source;
    const LightWindow& window;
    const LightHistory& like;

    /// Where the light from a place falls on the plane; none where the history is not, or goes away from it.
    std::optional<Vec2> fall(const Vec2& place, const ReceiverPlane& plane,
                             SinglePath* single = nullptr) const;

    /// From places near a triangle of a beam, whose affine map is the first derivative; none where Newton's
    /// method finds none. `tolerance`: on the plane, world units.
    std::optional<ExactArrival> arrive(const std::array<Vec2, 3>& places, const FallenBeam& fallen,
                                       const ReceiverPlane& plane, double tolerance) const;
};

}  // namespace trilens
