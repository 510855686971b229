// Texture filtering: anisotropic look-ups in a mip map, of repeated pictures and of pictures wrapped around
// the sphere of directions.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "base/description/material.h"
#include "base/image/texture_lookup.h"
#include "base/math/vec.h"
#include "base/util/parallel.h"

namespace trilens {

/// A picture and its means over squares of 2, 4, 8, ... texels, made when first asked for.
/// Source: Williams, Pyramidal Parametrics, SIGGRAPH 1983.
class MipMap {
  public:
    /// `texture` has texels.
    explicit MipMap(std::shared_ptr<const Texture> texture) : texture_(std::move(texture)) {}

    /// Levels down to one texel.
    std::size_t level_count() const;
    /// Level 0 is the picture itself; each has half the texels of the one before along both sides, rounded
    /// down, and the same mean. level < level_count().
    const Texture& level(std::size_t level) const;
    const std::shared_ptr<const Texture>& texture() const { return texture_; }

  private:
    std::shared_ptr<const Texture> texture_;
    Lazy<std::vector<Texture>> coarser_;
};

/// What a look-up stands for: a parallelogram about its place, by its two sides.
using Footprint = std::array<Vec2, 2>;

/// The mean of the picture over a footprint, whose sides are in units of `place`: seen at the coarsest level
/// whose texels are no wider than the rectangle that the pixel's square becomes when it is turned until its
/// image has right angles, at places along the footprint's sides, a quarter of a texel apart where it is
/// small, else a texel at most. One that is more than 32 times as long as wide is widened. Sides of less than
/// a twentieth of a texel are points. Against OpenImageIO's anisotropic look-ups, see docs/accuracy.md.
Vec3 lookup(const MipMap& map, const TextureSampler& wrap, const Vec2& place, const Footprint& footprint);

/// A footprint and where it lies.
struct FootprintAt {
    Vec2 place{0};
    Footprint sides{};
};

/// The mean of what at(place) shows, of which the picture has the means over texels: where that is less than
/// a footprint asks for it is looked at place by place.
Vec3 lookup(const MipMap& means, const TextureSampler& wrap, const FootprintAt& footprint,
            const std::function<Vec3(const Vec2& place)>& at);

/// Bilinear look-up of a latitude-longitude picture: the middle column is -Z, the right half +X, the top row
/// +Y. `direction` need not be unit.
Vec3 lookup_latitude_longitude(const Texture& texture, const Vec3& direction);

/// The mean over a footprint: `sides`: what of the direction, not unit either, changes along them.
Vec3 lookup_latitude_longitude(const MipMap& map, const Vec3& direction, const std::array<Vec3, 2>& sides);

}  // namespace trilens
