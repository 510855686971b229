// Faces whose places are affine in their parameters: parallelograms and triangles.
#pragma once

#include <optional>

#include "base/raymesh/surface.h"

namespace trilens {

/// The place of (u, v) is corner + u * by_u + v * by_v; world frame.
struct AffineFace {
    Vec3 corner{0}, by_u{0}, by_v{0};
};

/// None where the face is not flat, or its parameters are not affine: its places are off by more than 1e-13
/// of how far it reaches from the world's origin.
std::optional<AffineFace> affine_face(const Surface& surface, Id face);

}  // namespace trilens
