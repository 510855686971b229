// Faces as sums of their control points, with weights that many faces have in common.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/raymesh/surface.h"
#include "surfaces/polynomial/polynomial_parts.h"

namespace trilens {

/// Control points relative to `origin`.
struct FaceControls {
    Vec3 origin{0};
    std::vector<Vec3> offsets;
};

/// Per quantity a weight of each control point.
using FaceStencils = std::array<std::vector<double>, kQuantities>;

/// What a surface also is whose faces are such sums. Thread-safe to read.
class HasStencils {
  public:
    virtual ~HasStencils() = default;
    /// Faces of one kind have the same weights everywhere; none where nothing is known of the face.
    virtual std::optional<std::uint64_t> kind(Id face) const = 0;
    /// Of a face that has a kind, in the order of the weights.
    virtual FaceControls controls(Id face) const = 0;
    /// Of a face that has a kind.
    virtual FaceStencils stencils(Id face, const Vec2& uv) const = 0;
};

}  // namespace trilens
