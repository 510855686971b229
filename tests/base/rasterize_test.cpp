// Facets that tile the film own every sample once.
#include <algorithm>
#include <array>

#include "base/math/side_of_edge.h"
#include "base/raymesh/rasterize.h"
#include "projector/random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

RayMesh screen_mesh(const std::vector<Vec3>& screen, const std::vector<IdTriple>& facets) {
    RayMesh mesh;
    mesh.screen = screen;
    mesh.rays.resize(screen.size(), {Vec3(0), Vec3(0, 0, 1)});
    mesh.facets = facets;
    return mesh;
}

/// How many facets of the mesh, each drawn alone, own each sample.
std::vector<int> cover_counts(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<int> count(grid.size(), 0);
    for (const IdTriple& facet : mesh.facets) {
        for (const Id s : rasterize_facets(screen_mesh(mesh.screen, {facet}), grid).sample) ++count[s];
    }
    return count;
}

std::size_t not_once(const std::vector<int>& counts) {
    std::size_t wrong = 0;
    for (const int c : counts) wrong += c != 1;
    return wrong;
}

/// Tiles the window with cells x cells quads, corners jittered (or snapped to samples), diagonals, windings
/// and starts at random. Every facet has corners of its own.
RayMesh random_tiling(Random& random, const SampleGrid& grid, int cells, bool snapped) {
    const auto row = static_cast<std::size_t>(cells + 1);
    std::vector<Vec3> point;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const auto at = [&](int k, int low, int extent) {
                const bool inside = k > 0 && k < cells;
                double x = (k + (inside ? random.uniform(-0.24, 0.24) : 0)) / cells;
                x = low + x * extent;
                return inside && snapped ? std::floor(x * grid.side) / grid.side + 0.5 / grid.side : x;
            };
            const double x = at(i, grid.x0, grid.width()), y = at(j, grid.y0, grid.height());
            point.push_back(Vec3(x, y, 1) * (snapped ? 1.0 : random.uniform(0.3, 3)));
        }
    }
    std::vector<Vec3> screen;
    std::vector<IdTriple> facets;
    const auto add = [&](std::array<std::size_t, 3> corner) {
        std::shuffle(corner.begin(), corner.end(), random.engine);
        const Id first = static_cast<Id>(screen.size());
        for (const std::size_t c : corner) screen.push_back(point[c]);
        facets.push_back({first, first + 1, first + 2});
    };
    for (std::size_t j = 0; j + 1 < row; ++j) {
        for (std::size_t i = 0; i + 1 < row; ++i) {
            const std::size_t a = j * row + i, b = a + 1, c = a + row, d = c + 1;
            if (random.below(2) == 0)
                add({a, b, c}), add({b, d, c});
            else
                add({a, b, d}), add({a, d, c});
        }
    }
    return screen_mesh(screen, facets);
}

/// The oracle: every sample asks every facet, each by the exact sides of its three edges.
std::vector<Id> owners_one_by_one(const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Id> owner(grid.size(), kNone);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f) || facet_weights(mesh, f).edge_on) continue;
        std::array<Vec3, 3> corner;
        bool in_front = true;
        for (std::size_t k = 0; k < 3; ++k) {
            corner[k] = mesh.screen[mesh.facets[f][k]];
            in_front = in_front && corner[k].z > 0;
        }
        const int wanted = in_front ? 0 : triple(corner[0], corner[1], corner[2]) > 0 ? 1 : -1;
        for (std::size_t s = 0; s < grid.size(); ++s) {
            const Vec2 at = grid.position(s);
            std::array<Vec3, 3> local;
            for (std::size_t k = 0; k < 3; ++k)
                local[k] = {corner[k].x - at.x * corner[k].z, corner[k].y - at.y * corner[k].z, corner[k].z};
            const int side = side_of_edge(local[0], local[1]);
            const bool same = side_of_edge(local[1], local[2]) == side &&
                              side_of_edge(local[2], local[0]) == side && side != 0;
            if (owner[s] == kNone && same && (wanted == 0 || side == wanted)) owner[s] = static_cast<Id>(f);
        }
    }
    return owner;
}

std::vector<Id> owners(const FacetSamples& owned, std::size_t samples) {
    std::vector<Id> owner(samples, kNone);
    for (std::size_t f = 0; f + 1 < owned.first.size(); ++f)
        for (const Id s : owned.of(f)) owner[s] = static_cast<Id>(f);
    return owner;
}

/// Facets of any shape: slivers, corners on samples or far off, some behind the camera.
RayMesh random_facets(Random& random, const SampleGrid& grid, int count) {
    std::vector<Vec3> screen;
    std::vector<IdTriple> facets;
    const double reach = random.below(3) == 0 ? 100 : 1;
    for (int f = 0; f < count; ++f) {
        const Id first = static_cast<Id>(screen.size());
        Vec3 before(0);
        for (int k = 0; k < 3; ++k) {
            double x = grid.x0 + grid.width() * (0.5 + reach * random.uniform(-1, 1));
            double y = grid.y0 + grid.height() * (0.5 + reach * random.uniform(-1, 1));
            if (random.below(2) == 0)
                x = std::floor(x * grid.side) / grid.side + 0.5 / grid.side,
                y = std::floor(y * grid.side) / grid.side + 0.5 / grid.side;
            if (k > 0 && random.below(4) == 0) x = before.x + random.log_uniform(1e-14, 1);
            if (k > 0 && random.below(6) == 0) y = before.y;
            before = {x, y, 1};
            double depth = random.below(2) == 0 ? 1 : random.log_uniform(1e-4, 1e4);
            if (random.below(8) == 0) depth = -depth;
            screen.push_back(before * depth);
        }
        facets.push_back({first, first + 1, first + 2});
    }
    return screen_mesh(screen, facets);
}

}  // namespace

TEST_CASE("owners found row by row are those that every sample finds for itself", "[base][law]") {
    Random random(15);
    std::size_t wrong = 0, owned_samples = 0;
    for (int i = 0; i < 1500; ++i) {
        const int far = i % 3 == 0 ? 1000000 : 3000;
        const int x0 = random.below(2 * far) - far, y0 = random.below(2 * far) - far;
        const SampleGrid grid{x0, y0, x0 + 1 + random.below(40), y0 + 1 + random.below(30), 1 + i % 3};
        const RayMesh mesh = i % 5 == 0 ? random_tiling(random, grid, 1 + random.below(6), i % 2 == 0)
                                        : random_facets(random, grid, 1 + random.below(8));
        const std::vector<Id> expected = owners_one_by_one(mesh, grid);
        const std::vector<Id> found = owners(rasterize_facets(mesh, grid), grid.size());
        for (std::size_t s = 0; s < grid.size(); ++s) {
            wrong += found[s] != expected[s];
            owned_samples += expected[s] != kNone;
        }
    }
    CHECK(wrong == 0);
    CHECK(owned_samples > 100000);
}

TEST_CASE("most of a large facet's row is decided at its ends", "[base]") {
    const SampleGrid grid{0, 0, 1920, 1080, 1};
    const FacetEdges edges({Vec3(-5, -7, 1), Vec3(2500, 3, 1), Vec3(100, 2300, 1)}, 0, grid);
    std::size_t asked = 0, covered = 0;
    for (std::size_t row = 0; row < 1080; ++row) {
        const RowSpan cover = edges.cover(row, 0, 1920);
        asked += cover.sure_begin - cover.begin + cover.end - cover.sure_end;
        covered += cover.sure_end - cover.sure_begin;
    }
    CHECK(asked < 6 * 1080);
    CHECK(covered > 1000000);
}

TEST_CASE("facets that tile the film own every sample exactly once", "[base][law]") {
    Random random(12);
    std::size_t wrong = 0, unowned = 0;
    for (int i = 0; i < 120; ++i) {
        const int x0 = random.below(4000) - 2000, y0 = random.below(4000) - 2000;
        const SampleGrid grid{x0, y0, x0 + 40, y0 + 32, 1 + i % 3};
        const RayMesh mesh = random_tiling(random, grid, 1 + random.below(6), i % 2 == 0);
        wrong += not_once(cover_counts(mesh, grid));
        unowned += grid.size() - rasterize_facets(mesh, grid).sample.size();
    }
    CHECK(wrong == 0);
    CHECK(unowned == 0);
}

TEST_CASE(
    "around a camera inside a closed box, walls behind it and through it included, every sample has one "
    "facet",
    "[base][law]") {
    Random random(13);
    const SampleGrid grid{0, 0, 24, 24, 1};
    constexpr std::array<std::array<int, 4>, 6> kFaces{
        {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
    std::size_t wrong = 0;
    for (int i = 0; i < 200; ++i) {
        const double scale = random.log_uniform(1e-4, 1e4);
        const Vec3 inside = random.in_cube(0.9);
        const Quat turn =
            glm::normalize(Quat{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), 0.1});
        std::vector<Vec3> screen;
        for (int k = 0; k < 8; ++k) {
            const Vec3 p = scale * (turn * (Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1) - inside));
            screen.push_back({20 * p.x + 12 * p.z, 20 * p.y + 12 * p.z, p.z});
        }
        std::vector<IdTriple> facets;
        for (const auto& f : kFaces) {
            const std::array<Id, 4> c{static_cast<Id>(f[0]), static_cast<Id>(f[1]), static_cast<Id>(f[2]),
                                      static_cast<Id>(f[3])};
            facets.push_back({c[0], c[1], c[2]});
            facets.push_back({c[0], c[2], c[3]});
        }
        wrong += not_once(cover_counts(screen_mesh(screen, facets), grid));
    }
    CHECK(wrong == 0);
}

TEST_CASE("samples on an edge or a corner go to the facet right of it or below it", "[base]") {
    // The diagonal and the outline of a square from the centre of pixel 2 to that of pixel 5 run through
    // samples.
    const SampleGrid grid{0, 0, 8, 8, 1};
    const std::vector<Vec3> screen{{2.5, 2.5, 1}, {5.5, 2.5, 1}, {5.5, 5.5, 1}, {2.5, 5.5, 1}};
    const FacetSamples owned = rasterize_facets(screen_mesh(screen, {{0, 1, 2}, {0, 2, 3}}), grid);
    CHECK(owned.sample.size() ==
          9);  // the left and top outline belong to the square, the right and bottom do not
    const auto owns = [&](std::size_t facet, int x, int y) {
        const auto of = owned.of(facet);
        return std::find(of.begin(), of.end(), static_cast<Id>(grid.first_sample(x, y))) != of.end();
    };
    for (int k = 2; k < 5; ++k) CHECK(owns(0, k, k));
    CHECK(owns(0, 3, 2));
    CHECK(owns(1, 2, 3));
}

TEST_CASE("where facets overlap the smaller index owns; facets without rays or area own nothing", "[base]") {
    const SampleGrid grid{0, 0, 4, 4, 1};
    const std::vector<Vec3> screen{{-9, -9, 1}, {30, -9, 1}, {-9, 30, 1}};
    const RayMesh mesh = screen_mesh(screen, {{0, 1, 1}, {kNone, kNone, kNone}, {0, 1, 2}, {2, 1, 0}});
    const FacetSamples owned = rasterize_facets(mesh, grid);
    CHECK(owned.of(0).empty());
    CHECK(owned.of(1).empty());
    CHECK(owned.of(2).size() == grid.size());
    CHECK(owned.of(3).empty());
}

TEST_CASE("the sign of a difference of products is exact", "[base]") {
    // Integers of 53 bits have exact products in 128; c and d lie so close to a and b that double sees no
    // difference.
    __extension__ using Wide = __int128;
    Random random(14);
    std::size_t equal_in_double = 0, wrong = 0;
    for (int i = 0; i < 20000; ++i) {
        const double a = std::floor(random.uniform(0x1p52, 0x1p53));
        const double b = a + random.below(9) - 4, c = a + random.below(9) - 4, d = b + random.below(9) - 4;
        const Wide exact =
            static_cast<Wide>(a) * static_cast<Wide>(b) - static_cast<Wide>(c) * static_cast<Wide>(d);
        const int sign = exact > 0 ? 1 : exact < 0 ? -1 : 0;
        const double value = difference_of_products(a, b, c, d);
        equal_in_double += a * b == c * d && sign != 0;
        wrong += sign_of_difference(a, b, c, d) != sign || sign_of_difference(c, d, a, b) != -sign;
        wrong +=
            std::fabs(value - static_cast<double>(exact)) > 4e-16 * std::fabs(static_cast<double>(exact));
    }
    CHECK(equal_in_double > 100);
    CHECK(wrong == 0);
    const double e = 0x1p-52;
    CHECK(sign_of_difference(1 + e, 1 - e, 1, 1) == -1);
    CHECK(sign_of_difference(1, 1, 1 + e, 1 - e) == 1);
    CHECK(sign_of_difference(3, 5, 5, 3) == 0);
    CHECK(side_of_edge({0, -1, 1}, {0, 1, 1}) == -side_of_edge({0, 1, 1}, {0, -1, 1}));
    CHECK(side_of_edge({0, 0, 1}, {0, 0, 1}) == 0);
}
