// How the rays of a RayMesh change over the film, continuously from facet to facet.
#pragma once

#include <vector>

#include "base/raymesh/ray_mesh.h"

namespace trilens {

/// How a mesh's rays change with the film's x and y.
struct RaySlope {
    Vec3 origin_x{0}, origin_y{0}, direction_x{0}, direction_y{0};

    void add(const RaySlope& other, double share) {
        origin_x += share * other.origin_x, origin_y += share * other.origin_y;
        direction_x += share * other.direction_x, direction_y += share * other.direction_y;
    }
};

/// Inside a facet, where its unnormalised weights are `e`.
RaySlope slope_in_facet(const RayMesh& mesh, std::size_t facet, const FacetWeights& weights, const Vec3& e);

/// Per corner the mean over the facets around it, of second order in their size; zero where all of them are
/// edge-on or behind the camera.
std::vector<RaySlope> corner_slopes(const RayMesh& mesh);

}  // namespace trilens
