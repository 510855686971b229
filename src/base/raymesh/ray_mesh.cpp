#include "base/raymesh/ray_mesh.h"

#include <cmath>

namespace trilens {

FacetWeights facet_weights(const RayMesh& mesh, std::size_t facet) {
    const IdTriple& corner = mesh.facets[facet];
    const Vec3& a = mesh.screen[corner[0]];
    const Vec3& b = mesh.screen[corner[1]];
    const Vec3& c = mesh.screen[corner[2]];

    // Move the screen's origin to the facet and scale it to order one, so that the cofactors do not cancel.
    const double depth = std::fmax(std::fmax(std::fabs(a.z), std::fabs(b.z)), std::fabs(c.z));
    if (!(depth > 0)) return {};
    const Vec3& nearest = std::fabs(a.z) == depth ? a : std::fabs(b.z) == depth ? b : c;
    const Vec2 centre(nearest.x / nearest.z, nearest.y / nearest.z);
    auto local = [&](const Vec3& s) { return Vec3(s.x - centre.x * s.z, s.y - centre.y * s.z, s.z) / depth; };
    const Vec3 la = local(a), lb = local(b), lc = local(c);

    // The inverse's rows are the cross products of the columns over the determinant.
    const Vec3 row0 = cross(lb, lc), row1 = cross(lc, la), row2 = cross(la, lb);
    const double determinant = dot(la, row0);
    const double size = length(la) * length(lb) * length(lc);
    if (!(std::fabs(determinant) > 1e-14 * size) || !std::isfinite(determinant)) return {};
    Mat3 inverse = glm::transpose(Mat3(row0, row1, row2)) / determinant;

    // Undo the shift of the origin: (x, y, 1) -> (x - cx, y - cy, 1).
    inverse[2] -= inverse[0] * centre.x + inverse[1] * centre.y;
    return {inverse, false};
}

}  // namespace trilens
