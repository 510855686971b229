#include "base/raymesh/surface.h"

#include <algorithm>
#include <tuple>

namespace trilens {

int body_orientation(const SurfaceGrid& grid) {
    std::vector<std::tuple<Id, Id, int>> edges;  // from the lower point to the higher, and which way it runs
    edges.reserve(3 * grid.facets.size());
    double volume = 0;
    for (const IdTriple& facet : grid.facets) {
        std::array<Id, 3> point{};
        for (std::size_t k = 0; k < 3; ++k) point[k] = grid.corner_point[facet[k]];
        const auto from_first = [&](std::size_t k) { return grid.points[point[k]] - grid.points[0]; };
        volume += triple(from_first(0), from_first(1), from_first(2));
        for (std::size_t k = 0; k < 3; ++k) {
            const Id a = point[k], b = point[(k + 1) % 3];
            edges.emplace_back(std::min(a, b), std::max(a, b), a < b ? 1 : -1);
        }
    }
    std::sort(edges.begin(), edges.end());
    for (std::size_t i = 0; i < edges.size(); i += 2) {
        if (i + 1 == edges.size()) return 0;
        const auto& [a, b, one_way] = edges[i];
        const auto& [c, d, other_way] = edges[i + 1];
        if (a != c || b != d || one_way + other_way != 0) return 0;
    }
    return volume > 0 ? 1 : volume < 0 ? -1 : 0;
}

void append_facets(const SurfaceGrid& grid, Id object, TriangleScene& scene) {
    const Id first = static_cast<Id>(scene.points.size());
    scene.points.insert(scene.points.end(), grid.points.begin(), grid.points.end());
    for (std::size_t f = 0; f < grid.facets.size(); ++f) {
        IdTriple corner;
        for (std::size_t k = 0; k < 3; ++k) corner[k] = first + grid.corner_point[grid.facets[f][k]];
        scene.triangles.push_back(corner);
        scene.object.push_back(object);
        scene.primitive.push_back(static_cast<Id>(f));
    }
}

}  // namespace trilens
