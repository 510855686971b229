// Interpolates a facet's corner rays with each part of its weights.
#include "projector/exact/facet_rays.h"

namespace trilens {

FacetRays make_facet_rays(const FacetOnScreen& facet) {
    const IdTriple& corner = facet.mesh.facets[facet.facet];
    // The corner furthest in front of the camera: its projection lies on the facet.
    Id reference = corner[0];
    for (const Id c : corner) {
        if (facet.mesh.screen[c].z > facet.mesh.screen[reference].z) reference = c;
    }
    const Vec3& place = facet.mesh.screen[reference];

    FacetRays result;
    if (place.z > 0) result.screen = {place.x / place.z, place.y / place.z};
    result.centre = facet.mesh.rays[reference].origin;
    const std::array<Vec3, 3> e{facet.weights.unnormalised(result.screen.x, result.screen.y),
                                facet.weights.weights_from_screen[0], facet.weights.weights_from_screen[1]};
    for (std::size_t part = 0; part < 3; ++part) {
        for (int k = 0; k < 3; ++k) {
            const Ray& ray = facet.mesh.rays[corner[static_cast<std::size_t>(k)]];
            result.rays.origin[part] += e[part][k] * (ray.origin - result.centre);
            result.rays.direction[part] += e[part][k] * ray.direction;
            result.rays.weight[part] += e[part][k];
        }
    }
    return result;
}

}  // namespace trilens
