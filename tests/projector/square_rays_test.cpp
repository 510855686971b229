// What is seen over squares of the screen: what is sure of a square is what each ray in it sees by the plain
// engine.
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "engines_compared.h"
#include "projector/squares/square_rays.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();

struct SquareTally {
    std::size_t squares = 0, sure = 0, seen = 0;
    std::size_t different = 0;  // rays that see another surface than their square's
    std::size_t missing = 0;    // rays that see what was not kept, or nothing where something surely is
};

/// All pixels of the grid, by the first facet.
void compare_squares(const Case& c, SquareTally& tally) {
    const FacetWeights weights = facet_weights(c.mesh, 0);
    if (weights.edge_on) return;
    const FacetRays facet = make_facet_rays({c.mesh, 0, weights});
    const PreparedScene scene(c.scene);
    std::vector<Hit> plain(c.grid.size());
    draw(scene, c.mesh, c.owned, c.grid, plain, {.vectors = false});
    const std::size_t per_pixel = static_cast<std::size_t>(c.grid.samples_per_pixel());
    std::vector<SquareTriangle> triangles, kept;
    for (std::size_t p = 0; p < c.grid.pixels(); ++p) {
        const std::size_t across = static_cast<std::size_t>(c.grid.width());
        const Vec2 low(c.grid.x0 + static_cast<double>(p % across),
                       c.grid.y0 + static_cast<double>(p / across));
        const SquareRays rays(facet, low, low + Vec2(1));
        if (!rays.has_rays()) continue;
        triangles.clear();
        kept.clear();
        collect_triangles(
            scene, facet.centre, rays, [&](Id t) { return c.scene.object[t]; }, triangles);
        const SquareSight sight = see_first(rays, kEndless, triangles, kept);
        ++tally.squares;
        tally.sure += sight.is_sure;
        tally.seen += sight.is_sure && sight.surface != kNone;
        for (std::size_t s = p * per_pixel; s < (p + 1) * per_pixel; ++s) {
            const Id surface = plain[s].seen() ? c.scene.object[plain[s].triangle] : kNone;
            tally.different += sight.is_sure && surface != sight.surface;
            tally.missing += surface == kNone ? sight.is_closed
                                              : std::none_of(kept.begin(), kept.end(), [&](const auto& one) {
                                                    return one.surface == surface;
                                                });
        }
    }
}

FacetSamples of_first_facet(const SampleGrid& grid, std::size_t facets) {
    return group_by_facet(std::vector<Id>(grid.size(), 0), facets);
}

void check(const SquareTally& tally) {
    INFO(tally.sure << " of " << tally.squares << " sure, " << tally.seen << " of a surface");
    CHECK(tally.different == 0);
    CHECK(tally.missing == 0);
    CHECK(tally.sure > tally.squares / 3);
    CHECK(tally.seen > tally.squares / 20);
}

/// A camera at the origin that looks along z, of one facet: its pixel (x, y) sees the direction (x, y, 1).
FacetRays pinhole() {
    RayMesh mesh;
    for (const Vec2& at : {Vec2(-9, -9), Vec2(9, -9), Vec2(0, 9)}) {
        mesh.screen.push_back({at.x, at.y, 1});
        mesh.rays.push_back({Vec3(0), {at.x, at.y, 1}});
    }
    mesh.facets = {{0, 1, 2}};
    return make_facet_rays({mesh, 0, facet_weights(mesh, 0)});
}

SquareSight see(std::vector<SquareTriangle> triangles) {
    const SquareRays rays(pinhole(), {0, 0}, {1, 1});
    REQUIRE(rays.has_rays());
    std::vector<SquareTriangle> kept;
    return see_first(rays, kEndless, triangles, kept);
}

}  // namespace

TEST_CASE("squares that surely see one surface do so with all rays, for rays and screens of every kind",
          "[projector][law]") {
    Random random(41);
    SquareTally tally;
    for (int i = 0; i < 300; ++i) {
        const int x0 = random.below(2000);
        const SampleGrid grid{x0, 7, x0 + 8 + random.below(20), 7 + 8 + random.below(20), 4};
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
        const TriangleScene scene = random_triangles(random, frame, 1 + random.below(40));
        compare_squares({scene, mesh, grid, of_first_facet(grid, 1)}, tally);
    }
    check(tally);
}

TEST_CASE("squares that surely see one surface do so with all rays, in a bowed mirror's meshed room",
          "[projector][law]") {
    Random random(42);
    SquareTally tally;
    for (int i = 0; i < 12; ++i) {
        const SampleGrid grid{3, 5, 43, 37, 4};
        const Frame frame = random_frame(random);
        const RayMesh mesh = bowed_mesh(grid, frame, 1);
        const TriangleScene scene = bumpy_room(frame, 1 + random.below(6));
        compare_squares({scene, mesh, grid, of_first_facet(grid, mesh.facets.size())}, tally);
    }
    check(tally);
}

TEST_CASE("neighbours cover a square together, a gap, a fold and what stands before it do not",
          "[projector]") {
    const Vec3 a(-4, -4, 2), b(6, -4, 2), c(6, 6, 2), d(-4, 6, 2);
    CHECK(see({}).is_sure);
    CHECK(see({}).surface == kNone);
    CHECK_FALSE(see({{{a, b, c}, 7}}).is_sure);
    const SquareSight both = see({{{a, b, c}, 7}, {{c, d, a}, 7}});
    CHECK(both.is_sure);
    CHECK(both.surface == 7);
    CHECK(see({{{b, a, c}, 7}, {{c, d, a}, 7}}).is_sure);  // winding does not matter
    CHECK_FALSE(see({{{a, b, c}, 7}, {{c, d, a}, 8}}).is_sure);
    CHECK(see({{{a, b, c}, 7}, {{c, d, a}, 8}}).is_closed == false);
    CHECK_FALSE(see({{{a, b, c}, 7}, {{c, d, a + Vec3(0, 0, 1e-9)}, 7}}).is_sure);  // no shared edge
    // The second lies over the first: the surface folds at the edge.
    CHECK_FALSE(see({{{a, b, c}, 7}, {{c, b + Vec3(0, 0.1, 0.1), a}, 7}}).is_sure);

    const std::vector<SquareTriangle> wall{{{a, b, c}, 7}, {{c, d, a}, 7}};
    std::vector<SquareTriangle> more = wall;
    more.push_back({{0.5 * a, 0.5 * b, 0.5 * Vec3(1, 1.2, 2)}, 9});
    CHECK_FALSE(see(more).is_sure);  // before it
    more = wall;
    more.push_back({{2.0 * a, 2.0 * b, 2.0 * Vec3(1, 1.2, 2)}, 9});
    CHECK(see(more).surface == 7);
    CHECK(see(more).is_sure);  // behind it
}
