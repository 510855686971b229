// Keys of whole pixels: those of all their samples, also where facets meet in a pixel.
#include <algorithm>
#include <array>

#include "laws/worlds.h"
#include "render/engines/border_pixels.h"
#include "render/engines/engine.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

TEST_CASE("a pixel's key is that of all its samples", "[laws][law][fragments]") {
    for (const char* scene : {"sphere", "saddle", "torus", "cameras", "paths/crystal-ball", "paths/prism",
                              "paths/glass-before-mirror", "paths/mirror-balls"}) {
        CAPTURE(scene);
        const auto world = shipped_world(scene, 8, 64, 48);
        world->scene.film.spp = 3;
        const std::unique_ptr<Viewer> viewer = make_viewer(*world, {}, Engine::kExact, ignore);
        const SampleGrid grid{3, 2, 60, 47, 3, SampleOrder::kLattice};
        std::vector<FragmentKey> keys(grid.size()), of_pixels(grid.pixels());
        viewer->find_keys_of_pixels(grid, of_pixels);
        viewer->find_keys(grid, keys);
        std::size_t known = 0, one = 0, unlike = 0;
        for (std::size_t p = 0; p < of_pixels.size(); ++p) {
            const std::size_t width = static_cast<std::size_t>(grid.width());
            const FragmentKey first = keys[grid.sample_at(p % width * 3, p / width * 3)];
            bool same = first != kAlone;
            for (std::size_t j = 0; j < 3; ++j)
                for (std::size_t i = 0; i < 3; ++i) {
                    const FragmentKey key = keys[grid.sample_at(p % width * 3 + i, p / width * 3 + j)];
                    same = same && key == first;
                    unlike += of_pixels[p] != kAlone && key != of_pixels[p];
                }
            known += of_pixels[p] != kAlone;
            one += same;
        }
        INFO(known << " known of " << one << " that are one fragment");
        CHECK(unlike == 0);
        CHECK(known > one / 2);
    }
}

TEST_CASE("facets cover a pixel together where they share all edges in it", "[laws][fragments]") {
    // Four facets around a point, seen along z; pixels are squares of rays.
    SurfaceGrid grid;
    grid.points = {{0, 0, -2}, {1, 0, -2}, {0, 1, -2}, {-1, 0, -2}, {0, -1, -2}};
    grid.corner_point = {0, 1, 2, 3, 4};
    grid.facets = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}};
    grid.facet_face = {0, 0, 0, 0};
    const auto around = [](const Vec2& at) {
        std::array<Ray, 4> rays;
        for (std::size_t k = 0; k < 4; ++k)
            rays[k] = {Vec3(0), {at.x + (k % 2 ? 0.1 : -0.1), at.y + (k / 2 ? 0.1 : -0.1), -1}};
        return rays;
    };
    const auto joint = [&](const Vec2& at, std::vector<Id> candidates) {
        std::vector<PixelTriangle> list;
        for (const Id facet : candidates) list.push_back({0, facet});
        return joint_facets(grid, list, around(at));
    };
    const auto over_edge = joint({0.2, 0}, {0, 1, 2, 3});
    REQUIRE(over_edge);
    std::vector<Id> facets = over_edge->facets;
    std::sort(facets.begin(), facets.end());
    CHECK(facets == std::vector<Id>{0, 3});
    CHECK(over_edge->seen.t_low < 2);
    CHECK(over_edge->seen.t_high > 2);

    const auto over_point = joint({0, 0.02}, {0, 1, 2, 3});
    REQUIRE(over_point);
    CHECK(over_point->facets.size() == 4);

    CHECK_FALSE(joint({0, 0.02}, {0, 1, 3}));        // one of them is missing
    CHECK_FALSE(joint({0.25, 0.25}, {0, 1, 2, 3}));  // over the outline
    CHECK_FALSE(joint({0, 0}, {}));
    grid.facet_face[3] = 1;
    CHECK_FALSE(joint({0.2, 0}, {0, 1, 2, 3}));  // faces are told apart
}
