// The bins of a grid's facets against a look at every facet.
#include "render/frame/frame.h"

#include <algorithm>
#include <random>
#include <vector>

#include "support/test.h"

using namespace trilens;

namespace {

/// As the bins should answer: the first facet of the face whose three sides have the position within 1e-9.
Id first_facet_that_holds(const SurfaceGrid& grid, Id face, const Vec2& uv) {
    for (std::size_t f = 0; f < grid.facets.size(); ++f) {
        if (grid.facet_face[f] != face) continue;
        const auto& [a, b, c] = grid.facet_uv[f];
        const auto area = [](const Vec2& p, const Vec2& q, const Vec2& r) {
            return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        };
        const double all = area(a, b, c);
        if (all != 0 && area(a, b, uv) / all >= -1e-9 && area(b, c, uv) / all >= -1e-9 &&
            area(c, a, uv) / all >= -1e-9)
            return static_cast<Id>(f);
    }
    return kNone;
}

/// Faces of n x n squares in two facets each, a face of one facet, one of a facet without area, and one of
/// none.
SurfaceGrid uneven_grid(std::mt19937& random, int n) {
    SurfaceGrid grid;
    const auto add = [&](Id face, const Vec2& a, const Vec2& b, const Vec2& c) {
        grid.facets.push_back({0, 0, 0});
        grid.facet_face.push_back(face);
        grid.facet_uv.push_back({a, b, c});
    };
    // Lines at uneven distances, as a grid adapted to its surface has them.
    std::uniform_real_distribution<double> unit(0, 1);
    std::vector<double> line{0, 1};
    for (int k = 1; k < n; ++k) line.push_back(unit(random));
    std::sort(line.begin(), line.end());
    for (std::size_t i = 0; i + 1 < line.size(); ++i)
        for (std::size_t j = 0; j + 1 < line.size(); ++j) {
            const Vec2 a(line[i], line[j]), c(line[i + 1], line[j + 1]);
            add(0, a, {c.x, a.y}, c);
            add(0, a, c, {a.x, c.y});
        }
    add(1, {0, 0}, {1, 0}, {0, 1});
    add(2, {0, 0}, {0.5, 0.5}, {1, 1});
    return grid;
}

}  // namespace

TEST_CASE("bins of facets answer as a look at every facet", "[laws][oracle][law]") {
    std::mt19937 random(91);
    std::uniform_real_distribution<double> unit(0, 1);
    int inside = 0, outside = 0;
    for (const int n : {1, 2, 7, 16}) {
        const SurfaceGrid grid = uneven_grid(random, n);
        const FacetLookup lookup(grid, 4);
        for (int round = 0; round < 3000; ++round) {
            const Id face = static_cast<Id>(round % 4);
            Vec2 uv(unit(random), unit(random));
            // Corners, borders and places that rounding put outside.
            if (round % 3 == 0) uv = grid.facet_uv[static_cast<std::size_t>(round) % grid.facets.size()][0];
            if (round % 5 == 0) uv.x = grid.facet_uv.front()[1].x;
            if (round % 7 == 0) uv -= Vec2(1e-10);
            if (round % 11 == 0) uv += Vec2(1e-10, 0.3);
            const Id expected = first_facet_that_holds(grid, face, uv);
            CHECK(lookup.at(face, uv) == expected);
            ++(expected == kNone ? outside : inside);
        }
    }
    CHECK(inside > 2000);
    CHECK(outside > 2000);
}
