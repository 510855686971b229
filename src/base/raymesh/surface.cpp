#include "base/raymesh/surface.h"

namespace trilens {

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
