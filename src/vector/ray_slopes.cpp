#include "vector/ray_slopes.h"

namespace trilens {

RaySlope slope_in_facet(const RayMesh& mesh, std::size_t facet, const FacetWeights& weights, const Vec3& e) {
    const double whole = e.x + e.y + e.z;
    const auto change = [&](int axis) {  // of the weights
        const Vec3& column = weights.weights_from_screen[axis];
        return (column - e / whole * (column.x + column.y + column.z)) / whole;
    };
    const Vec3 x = change(0), y = change(1);
    RaySlope slope;
    for (int k = 0; k < 3; ++k) {
        const Ray& ray = mesh.rays[mesh.facets[facet][static_cast<std::size_t>(k)]];
        slope.add({ray.origin, Vec3(0), ray.direction, Vec3(0)}, x[k]);
        slope.add({Vec3(0), ray.origin, Vec3(0), ray.direction}, y[k]);
    }
    return slope;
}

std::vector<RaySlope> corner_slopes(const RayMesh& mesh) {
    std::vector<RaySlope> slopes(mesh.rays.size());
    std::vector<double> count(mesh.rays.size(), 0);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        const FacetWeights weights = facet_weights(mesh, f);
        if (weights.edge_on) continue;
        for (const Id corner : mesh.facets[f]) {
            const Vec3& at = mesh.screen[corner];
            if (!(at.z > 0)) continue;
            const Vec3 e = weights.unnormalised(at.x / at.z, at.y / at.z);
            slopes[corner].add(slope_in_facet(mesh, f, weights, e), 1);
            ++count[corner];
        }
    }
    for (std::size_t c = 0; c < slopes.size(); ++c) {
        RaySlope mean;
        if (count[c] > 0) mean.add(slopes[c], 1 / count[c]);
        slopes[c] = mean;
    }
    return slopes;
}

}  // namespace trilens
