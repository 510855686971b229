// A facet's three corner rays: one trilinear projection (Vallance 2005, chapters 2 and 3).
#pragma once

#include <array>
#include <cstddef>

#include "base/raymesh/ray.h"
#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// Three corner rays, world frame; directions are not unit. At every t the points origin + t * direction are
/// the corners of the parametric triangle, whose interior the facet's rays pass at that t.
struct TrilinearFacet {
    std::array<Ray, 3> corner;

    Vec3 corner_at(std::size_t k, double t) const { return corner[k].origin + t * corner[k].direction; }
    Vec3 origin(const Vec3& weights) const {
        return weights.x * corner[0].origin + weights.y * corner[1].origin + weights.z * corner[2].origin;
    }
    Vec3 direction(const Vec3& weights) const {
        return weights.x * corner[0].direction + weights.y * corner[1].direction +
               weights.z * corner[2].direction;
    }
    /// The world point at `t` on the ray of `weights` (which sum to 1; outside [0, 1] they extend the facet).
    Vec3 point(const Vec3& weights, double t) const { return origin(weights) + t * direction(weights); }
};

/// The corner rays of one facet of a mesh, which must have rays.
inline TrilinearFacet trilinear_facet(const RayMesh& mesh, std::size_t facet) {
    const IdTriple& c = mesh.facets[facet];
    return {{mesh.rays[c[0]], mesh.rays[c[1]], mesh.rays[c[2]]}};
}

}  // namespace trilens
