// A scene triangle's edges as the parametric triangle cuts them.
#include "trilinear/facet/scene_edge.h"

#include <algorithm>

namespace trilens {

bool canonically_before(const Vec3& a, const Vec3& b) {
    if (a.x != b.x) return a.x < b.x;
    if (a.y != b.y) return a.y < b.y;
    return a.z < b.z;
}

EdgePoint cut_edge(const Coplanarity& facet, double t, const Vec3& a, const Vec3& b) {
    if (canonically_before(b, a)) {
        const EdgePoint turned = cut_edge(facet, t, b, a);
        return {turned.to, turned.from, turned.point};
    }
    // The distances of both ends from the plane differ by the edge's own rise, which loses no digits when
    // they are close.
    const Vec3 normal = cross(facet.e1 + t * facet.f1, facet.e2 + t * facet.f2);
    const Vec3 base = facet.origin + t * facet.direction;
    const double rise = dot(normal, b - a);
    const double s = rise != 0 ? std::clamp(dot(normal, base - a) / rise, 0.0, 1.0) : 0.5;
    return {1 - s, s, a + s * (b - a)};
}

std::optional<ImageVertex> edge_cut(const Coplanarity& facet, const SceneTriangle& triangle, std::size_t edge,
                                    double t) {
    const EdgePoint cut = cut_edge(facet, t, triangle.from(edge), triangle.to(edge));
    const std::optional<Vec3> weights = weights_in_parametric_triangle(facet, t, cut.point);
    if (!weights) return std::nullopt;
    ImageVertex vertex{t, *weights, Vec3(0)};
    vertex.barycentric[static_cast<int>(edge)] = cut.from;
    vertex.barycentric[static_cast<int>((edge + 1) % 3)] = cut.to;
    return vertex;
}

}  // namespace trilens
