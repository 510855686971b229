// Meshes of quads over a whole film.
#pragma once

#include "base/raymesh/ray_mesh.h"
#include "base/raymesh/sample_grid.h"

namespace trilens_test {

/// cells x cells quads over the film, two facets each; `ray_at(x, y)` is the corner's ray, x and y from -1
/// to 1.
template <typename RayAt>
trilens::RayMesh film_mesh(const trilens::SampleGrid& grid, int cells, const RayAt& ray_at) {
    using trilens::Id;
    trilens::RayMesh mesh;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double x = 2.0 * i / cells - 1, y = 2.0 * j / cells - 1;
            mesh.rays.push_back(ray_at(x, y));
            mesh.screen.push_back(
                {grid.x0 + (x + 1) / 2 * grid.width(), grid.y0 + (y + 1) / 2 * grid.height(), 1});
        }
    }
    const Id row = static_cast<Id>(cells + 1);
    for (Id j = 0; j + 1 < row; ++j) {
        for (Id i = 0; i + 1 < row; ++i) {
            const Id a = j * row + i;
            mesh.facets.push_back({a, a + 1, a + row});
            mesh.facets.push_back({a + 1, a + row + 1, a + row});
        }
    }
    return mesh;
}

}  // namespace trilens_test
