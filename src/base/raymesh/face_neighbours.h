// Walks over a surface: a step that leaves its face goes on over the edge, on the face that shares it.
#pragma once

#include <optional>
#include <vector>

#include "base/raymesh/surface.h"

namespace trilens {

/// Whether every side of every face is one of two along its edge, so that the surface bounds a body.
bool is_closed(const Surface& surface);

/// Which faces of a surface share edges. Thread-safe to read; the surface must live longer.
class FaceNeighbours {
  public:
    explicit FaceNeighbours(const Surface& surface);

    /// From `at`, on its face's border, over the edge that it lies on and on along the tangent plane to below
    /// (or above) a point of space, over further edges as they come; the last place on the last border after
    /// kMostFaces of them. None where no other face shares the edge.
    std::optional<SurfaceParameter> over_edge(const SurfaceParameter& at, const Vec3& towards) const;

    static constexpr int kMostFaces = 8;

  private:
    struct Side {
        Id edge = kNone, face = kNone;
        int side = 0;
    };
    std::optional<SurfaceParameter> opposite(const SurfaceParameter& at, int side) const;

    const Surface& surface_;
    std::vector<Side> sides_;  // by edge, then face
};

}  // namespace trilens
