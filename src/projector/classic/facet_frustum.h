// Frustum culling for a facet: the space that its rays can reach, bounded by planes. Boxes beyond one of them
// are never hit.
#pragma once

#include <array>

#include "base/math/box.h"
#include "trilinear/facet/facet.h"

namespace trilens {

/// The rays over the parallelogram that two edges of a facet span start in the hull of the four origins at
/// its corners and go along the cone of the four directions there. Positions are from centre().
class FacetFrustum {
  public:
    explicit FacetFrustum(const TrilinearFacet& facet);

    /// Whether no ray of the facet meets the box. May say no although none does.
    bool misses(const Box& box) const;

    /// The first corner ray's origin, in the world.
    const Vec3& centre() const { return centre_; }

  private:
    struct Plane {
        Vec3 normal{0};     // unit but for a tiny turn, into the frustum
        double offset = 0;  // every point of the frustum has normal . x >= offset
    };
    void add_plane(const Vec3& normal);
    void add_axis();

    Vec3 centre_{0};
    std::array<Vec3, 4> origin_{}, direction_{}, unit_direction_{};  // around the parallelogram
    double origin_size_ = 0;
    std::array<Plane, 17> plane_{};
    std::size_t planes_ = 0;
    Vec3 axis_{0};
    double least_cosine_ = 0;  // between the axis and a direction; 0: too wide for an axis to mean anything
};

}  // namespace trilens
