// Gives each sample to the facet that covers it, by exact signs of homogeneous edge functions.
// Based on: Olano and Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates, 1997.
#include "base/rasterize.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/parallel.h"
#include "base/side_of_edge.h"

namespace trilens {
namespace {

/// Lines of samples [x0, x1) x [y0, y1) that a facet can cover, counted in samples from the window's corner.
struct SampleWindow {
    std::size_t x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

/// The facet's bounding rectangle in samples, one sample wider on each side against rounding.
SampleWindow window_of(const std::array<Vec3, 3>& corner, const SampleGrid& grid) {
    const std::size_t columns = static_cast<std::size_t>(grid.width() * grid.side);
    const std::size_t rows = static_cast<std::size_t>(grid.height() * grid.side);
    Vec2 lo(INFINITY), hi(-INFINITY);
    for (const Vec3& c : corner) {
        if (!(c.z > 0)) return {0, columns, 0, rows};
        lo = glm::min(lo, Vec2(c.x / c.z, c.y / c.z));
        hi = glm::max(hi, Vec2(c.x / c.z, c.y / c.z));
    }
    const auto line = [&](double at, int start, std::size_t end) {
        const double position = std::floor((at - start) * grid.side);
        return static_cast<std::size_t>(std::clamp(position, 0.0, static_cast<double>(end)));
    };
    return {line(lo.x - 1.0 / grid.side, grid.x0, columns), line(hi.x + 2.0 / grid.side, grid.x0, columns),
            line(lo.y - 1.0 / grid.side, grid.y0, rows), line(hi.y + 2.0 / grid.side, grid.y0, rows)};
}

struct ScreenFacet {
    Id facet = 0;
    std::array<Vec3, 3> corner{};
    SampleWindow window;
    int orientation = 0;  // sign of the determinant of the corners; 0: any, since all are in front
};

/// Whether the facet covers the sample: the edge functions have one sign, and the surface is in front there.
bool covers(const ScreenFacet& facet, const Vec2& sample) {
    std::array<Vec3, 3> local;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& c = facet.corner[k];
        local[k] = {c.x - sample.x * c.z, c.y - sample.y * c.z, c.z};
    }
    const int first = side_of_edge(local[0], local[1]);
    if (first == 0 || (facet.orientation != 0 && first != facet.orientation)) return false;
    return side_of_edge(local[1], local[2]) == first && side_of_edge(local[2], local[0]) == first;
}

std::vector<ScreenFacet> facets_on_screen(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<ScreenFacet> facets;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f) || facet_weights(mesh, f).edge_on) continue;
        ScreenFacet facet;
        facet.facet = static_cast<Id>(f);
        bool all_in_front = true;
        for (std::size_t k = 0; k < 3; ++k) {
            facet.corner[k] = mesh.screen[mesh.facets[f][k]];
            all_in_front = all_in_front && facet.corner[k].z > 0;
        }
        // Where a corner lies behind the camera, the corners' determinant tells front from behind: it is the
        // sum of the edge functions times the corners' depths.
        if (!all_in_front) {
            const double determinant = triple(facet.corner[0], facet.corner[1], facet.corner[2]);
            facet.orientation = determinant > 0 ? 1 : -1;
        }
        facet.window = window_of(facet.corner, grid);
        if (facet.window.x0 < facet.window.x1 && facet.window.y0 < facet.window.y1) facets.push_back(facet);
    }
    return facets;
}

std::size_t sample_at(const SampleGrid& grid, std::size_t column, std::size_t row) {
    const std::size_t side = static_cast<std::size_t>(grid.side),
                      width = static_cast<std::size_t>(grid.width());
    const std::size_t pixel = row / side * width + column / side;
    return pixel * side * side + row % side * side + column % side;
}

/// Rasterises rows of samples; facets ascend, so the first to claim a sample has the smallest index.
void fill_rows(const std::vector<ScreenFacet>& facets, const SampleGrid& grid, std::vector<Id>& owner,
               std::size_t first, std::size_t last) {
    for (const ScreenFacet& facet : facets) {
        const std::size_t end = std::min(last, facet.window.y1);
        for (std::size_t row = std::max(first, facet.window.y0); row < end; ++row) {
            for (std::size_t column = facet.window.x0; column < facet.window.x1; ++column) {
                const std::size_t sample = sample_at(grid, column, row);
                if (owner[sample] == kNone && covers(facet, grid.position(sample)))
                    owner[sample] = facet.facet;
            }
        }
    }
}

}  // namespace

FacetSamples rasterize_facets(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Id> owner(grid.size(), kNone);
    const std::vector<ScreenFacet> facets = facets_on_screen(mesh, grid);
    constexpr std::size_t kRowsTogether = 16;
    parallel_for(static_cast<std::size_t>(grid.height() * grid.side), kRowsTogether,
                 [&](std::size_t first, std::size_t last) { fill_rows(facets, grid, owner, first, last); });
    return group_by_facet(owner, mesh.facets.size());
}

}  // namespace trilens
