// The space that a block's rays can reach, bounded by planes: boxes beyond one of them are never hit.
#pragma once

#include <array>

#include "projector/blocks/block_rays.h"
#include "projector/scene/bvh.h"

namespace trilens {

/// The rays of a block start in the hull of the four origins at its rectangle's corners and go along the cone
/// of the four directions there (both by convexity, where the weights are positive). All positions are from
/// the block's centre.
class Beam {
  public:
    explicit Beam(const BlockRays& block);

    /// Whether no ray of the block meets the box. May say no although none does.
    bool misses(const Box& box) const;

    /// No ray of the block meets the box at a smaller t. 0 where nothing is known.
    double nearest(const Box& box) const;

  private:
    struct Plane {
        Vec3 normal{0};     // unit but for a tiny turn, into the beam
        double offset = 0;  // every point of the beam has normal . x >= offset
    };
    void add_plane(const Vec3& normal);
    void add_axis();

    std::array<Vec3, 4> origin_{}, direction_{}, unit_direction_{};  // around the rectangle
    double origin_size_ = 0;
    std::array<Plane, 17> plane_{};
    std::size_t planes_ = 0;
    Vec3 axis_{0};
    double least_cosine_ = 0;  // between the axis and a direction; 0: too wide for an axis to mean anything
    double axis_start_ = 0;    // the largest axis . origin
    double axis_speed_ = 0;    // the largest axis . direction; 0: `nearest` knows nothing
};

}  // namespace trilens
