// Texture look-up: bilinear, repeated or wrapped around the sphere of directions.
#pragma once

#include "base/description/texture.h"
#include "base/math/vec.h"

namespace trilens {

/// Bilinear look-up, repeated in both directions; u to the right, v upward, (0, 0) the picture's bottom left
/// corner.
Vec3 lookup_repeat(const Texture& texture, const Vec2& uv);

/// Bilinear look-up of a latitude-longitude picture: the middle column is -Z, the right half +X, the top row
/// +Y. `direction` need not be unit.
Vec3 lookup_latitude_longitude(const Texture& texture, const Vec3& direction);

}  // namespace trilens
