// The vector engine beside the plain one, in every leaf mode, in tiles and in vectors of mixed facets.
#pragma once

#include <cmath>
#include <vector>

#include "base/raymesh/rasterize.h"
#include "film_mesh.h"
#include "projector/projector.h"
#include "random_cases.h"

namespace trilens_test {

struct Tally {
    std::size_t samples = 0, seen = 0, different = 0;
};

inline bool same(const Hit& a, const Hit& b) {
    return a.triangle == b.triangle && (!a.seen() || (a.t == b.t && a.barycentric == b.barycentric));
}

/// The same triangle, and the hit's t within the bounds.
inline bool around(const Visible& visible, const Hit& hit) {
    return visible.triangle == hit.triangle &&
           (!hit.seen() ||
            (static_cast<double>(visible.t_low) <= hit.t && hit.t <= static_cast<double>(visible.t_high)));
}

struct Case {
    const TriangleScene& scene;
    const RayMesh& mesh;
    const SampleGrid& grid;
    FacetSamples owned;
};

inline void compare(const Case& c, const DrawOptions& options, Tally& tally) {
    const PreparedScene prepared(c.scene);
    std::vector<Hit> plain(c.grid.size()), fast(c.grid.size());
    draw(prepared, c.mesh, c.owned, c.grid, plain, {.vectors = false});
    draw(prepared, c.mesh, c.owned, c.grid, fast, options);
    std::vector<Visible> visible(c.grid.size());
    find_visible(prepared, c.mesh, c.owned, c.grid, visible, options);
    for (const Id s : c.owned.sample) {
        ++tally.samples;
        tally.seen += plain[s].seen();
        tally.different += !same(plain[s], fast[s]) || !around(visible[s], plain[s]);
    }
}

inline DrawOptions with(LeafMode mode, std::uint32_t mixed_below) {
    DrawOptions options;
    options.kernel.leaf_mode = mode;
    options.tiles.emplace().mixed_below = mixed_below;
    return options;
}

/// Every leaf mode with tiles alone, all samples in vectors of mixed facets, and what is done by default.
inline const std::vector<DrawOptions>& all_ways() {
    static const std::vector<DrawOptions> ways{with(LeafMode::kCheapest, 0),    with(LeafMode::kTriangles, 0),
                                               with(LeafMode::kFacets, 0),      with(LeafMode::kRays, 0),
                                               with(LeafMode::kRays, 1u << 30), DrawOptions{}};
    return ways;
}

/// Cells x cells quads over the film, a bowed mirror around the frame's origin.
inline RayMesh bowed_mesh(const SampleGrid& grid, const Frame& frame, int cells) {
    return film_mesh(grid, cells, [&](double x, double y) {
        return Ray{frame(Vec3(x, y, 0.3 * (x * x + y * y))), frame.scale * Vec3(0.6 * x, 0.6 * y, 1)};
    });
}

/// A closed bumpy room around the frame's origin.
inline TriangleScene bumpy_room(const Frame& frame, int cells) {
    TriangleScene scene;
    const auto point = [&](int wall, int i, int j) {
        const double x = 2.0 * i / cells - 1, y = 2.0 * j / cells - 1, s = wall % 2 == 0 ? 1 : -1;
        const Vec3 p = wall < 2 ? Vec3(s, x, y) : wall < 4 ? Vec3(x, s, y) : Vec3(x, y, s);
        return frame(8.0 * p *
                     (1 + 0.05 * std::sin(9 * p.x) * std::sin(7 * p.y + 1) * std::sin(8 * p.z + 2)));
    };
    for (int wall = 0; wall < 6; ++wall) {
        for (int j = 0; j < cells; ++j) {
            for (int i = 0; i < cells; ++i) {
                add_triangle(scene, point(wall, i, j), point(wall, i + 1, j), point(wall, i + 1, j + 1));
                add_triangle(scene, point(wall, i, j), point(wall, i + 1, j + 1), point(wall, i, j + 1));
            }
        }
    }
    return scene;
}

}  // namespace trilens_test
