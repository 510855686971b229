// The inside by areas, else the nearest of three edges.
#include "intersect/triangle_near_origin.h"

#include <algorithm>

namespace trilens {

NearestToOrigin nearest_to_origin(const PlaneTriangle& p) {
    const Vec3 areas(area_from_origin(p[1], p[2]), area_from_origin(p[2], p[0]),
                     area_from_origin(p[0], p[1]));
    const double sum = areas.x + areas.y + areas.z;
    const Vec3 weights = areas / sum;
    if (sum != 0 && weights.x >= 0 && weights.y >= 0 && weights.z >= 0) return {weights, 0};

    NearestToOrigin best;
    for (int k = 0; k < 3; ++k) {
        const Vec2 a = p[k], edge = p[(k + 1) % 3] - a;
        const double size_2 = dot(edge, edge);
        const double share = size_2 > 0 ? std::clamp(-dot(a, edge) / size_2, 0.0, 1.0) : 0.0;
        const double distance = length(a + share * edge);
        if (distance < best.distance) {
            best = {Vec3(0), distance};
            best.weights[k] = 1 - share;
            best.weights[(k + 1) % 3] = share;
        }
    }
    return best;
}

}  // namespace trilens
