// Which cells of a closed surface the surface itself hides from an eye: a closed surface separates space.
#pragma once

#include "base/math/vec.h"
#include "base/raymesh/surface.h"
#include "specular/cell_bvh.h"

namespace trilens {

/// What is known of a cell as an eye sees it; of kSeen, that its middle is.
enum class InSight { kUnknown, kSeen, kHidden };

/// Of surfaces whose cells have an occluder. Thread-safe to read; both must live longer.
class SelfOcclusion {
  public:
    SelfOcclusion(const Surface& surface, const CellBvh& cells) : surface_(surface), cells_(cells) {}

    /// Hidden: every way from the eye to the cell meets the surface before.
    ///
    /// Drawn nearer to the eye, scaled about it, the cell is a piece that every such way passes. Where the
    /// surface does not meet that piece, all of it lies in one part of the space that the surface leaves; and
    /// where the ray to its middle crosses the surface once, the eye lies in another.
    InSight look(const Vec3& eye, const CellBox& box, const SurfaceBounds& bounds) const;

  private:
    const Surface& surface_;
    const CellBvh& cells_;
};

}  // namespace trilens
