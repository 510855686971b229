// The rays of one facet over the screen: one family of coefficients that every engine starts from, bit for
// bit.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "base/raymesh/ray_mesh.h"
#include "trilinear/facet/scene_edge.h"

namespace trilens {

/// One facet and its weights on the screen.
struct FacetOnScreen {
    const RayMesh& mesh;
    std::size_t facet;
    FacetWeights weights;
};

/// The ray of one sample, times its weight: origin and direction are those of the ray times `weight`.
struct SampleRay {
    Vec3 origin{0}, direction{0};
    double weight = 1;
};

inline double largest_part(const Vec3& v) {
    return std::max(std::fabs(v.x), std::max(std::fabs(v.y), std::fabs(v.z)));
}

/// Depends on the facet alone, not on its samples. Positions in the world are measured from `centre`, one of
/// the facet's corner rays' origins, so that scenes far from the world's origin lose nothing; positions on
/// the screen from `screen`, a corner of the facet, so that the weights do not cancel.
struct FacetRays {
    Vec2 screen{0};   // pixels from the film's top left
    Vec3 centre{0};   // world frame
    AffineRays rays;  // over the offset from `screen`, in pixels

    /// The ray through a position of the screen. Its bits decide what a sample sees.
    SampleRay at(const Vec2& position) const {
        const Vec2 from = position - screen;
        return {rays.origin_at(from.x, from.y), rays.direction_at(from.x, from.y),
                rays.weight_at(from.x, from.y)};
    }
};

/// The facet has rays and is not edge-on.
FacetRays make_facet_rays(const FacetOnScreen& facet);

}  // namespace trilens
