#include "base/raymesh/ray_mesh.h"

#include <algorithm>
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

std::vector<Id> FacetsAround::ring(const IdTriple& vertices) const {
    std::vector<Id> found;
    for (const Id v : vertices) {
        const std::span<const Id> here = of(v);
        found.insert(found.end(), here.begin(), here.end());
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count,
                           const std::function<Id(Id corner)>& vertex_of) {
    FacetsAround around;
    around.first.assign(vertex_count + 1, 0);
    const auto each = [&](const auto& body) {
        for (Id f = 0; f < facets.size(); ++f)
            for (const Id corner : facets[f])
                if (corner != kNone) body(vertex_of(corner), f);
    };
    each([&](Id vertex, Id) { ++around.first[vertex + 1]; });
    for (std::size_t v = 1; v < around.first.size(); ++v) around.first[v] += around.first[v - 1];
    around.facet.resize(around.first.back());
    std::vector<std::size_t> next(around.first.begin(), around.first.end() - 1);
    each([&](Id vertex, Id f) { around.facet[next[vertex]++] = f; });
    return around;
}

FacetsAround facets_around(std::span<const IdTriple> facets, std::size_t vertex_count) {
    return facets_around(facets, vertex_count, [](Id corner) { return corner; });
}

}  // namespace trilens
