// The vector engine against the plain one: the same hits, bit for bit, in every leaf mode, in tiles and
// in vectors of mixed facets, and with every instruction set.
#include <algorithm>

#include "base/raymesh/rasterize.h"
#include "engines_compared.h"
#include "projector/kernel/kernel.h"
#include "projector/projector.h"
#include "projector/scene/bvh.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Large sheets over the film around the frame's origin, a hair before one another, crossing, and behind the
/// rays, with specks between them.
TriangleScene sheets(Random& random, const Frame& frame, int count) {
    TriangleScene scene;
    for (int i = 0; i < count; ++i) {
        const double z = random.below(4) == 0 ? -random.uniform(1, 5) : random.uniform(2, 6),
                     hair = random.log_uniform(1e-9, 0.3), wide = random.log_uniform(0.05, 30);
        const Vec3 lean = random.below(2) == 0 ? Vec3(0) : random.in_cube(0.1);
        const Vec3 middle = wide > 8 ? Vec3(0) : random.in_cube(2);
        for (const double depth : {z, z * (1 + hair)}) {
            const auto corner = [&](double x, double y) {
                return frame(Vec3(middle.x + wide * x, middle.y + wide * y,
                                  depth + lean.x * x * wide + lean.y * y * wide));
            };
            add_triangle(scene, corner(-1, -1), corner(1.1, -1), corner(0, 1.2));
        }
    }
    return scene;
}

}  // namespace

TEST_CASE("tiles that one triangle covers, with others before, behind and through it",
          "[projector][law][many]") {
    Random random(25);
    for (const DrawOptions& way : all_ways()) {
        Tally tally;
        for (int i = 0; i < 60; ++i) {
            const SampleGrid grid{0, 0, 80, 64, 1 + i % 2};
            const Frame frame = random_frame(random);
            const RayMesh mesh = bowed_mesh(grid, frame, 2 + random.below(14));
            // In a single leaf, and in a tree.
            const TriangleScene scene = sheets(random, frame, i % 3 == 0 ? 60 : 1 + random.below(8));
            compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, way, tally);
        }
        INFO("mode " << static_cast<int>(way.kernel.leaf_mode) << " mixed below "
                     << (way.tiles ? way.tiles->mixed_below : 0) << " samples " << tally.samples << " seen "
                     << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > tally.samples / 3);
        CHECK(tally.seen < tally.samples);
    }
}

/// What is visible, left in the vectors' order, beside the plain engine's hits.
void compare_in_order(const Case& c, Tally& tally) {
    const PreparedScene scene(c.scene);
    std::vector<Hit> plain(c.grid.size());
    draw(scene, c.mesh, c.owned, c.grid, plain, {.vectors = false});
    const SampleTiles tiles = make_sample_tiles(c.mesh, c.owned, c.grid, {});
    std::vector<VectorVisible> visible(tiles.vectors.size());
    KernelScene asked{&scene.data(), &scene.data().leaves, &c.mesh, &c.grid, &tiles};
    asked.vector_visible = visible;
    draw_tiles(asked, {});
    for (std::size_t v = 0; v < visible.size(); ++v) {
        for (std::size_t k = 0; k < kLanes; ++k) {
            if (!(tiles.valid[v] >> k & 1)) continue;
            const Hit& hit = plain[tiles.samples[v].sample[k]];
            ++tally.samples;
            tally.seen += hit.seen();
            tally.different +=
                !around({visible[v].triangle[k], visible[v].t_low[k], visible[v].t_high[k]}, hit);
        }
    }
}

TEST_CASE("what is visible, left in the order of vectors, holds the hits of the samples",
          "[projector][law]") {
    Random random(26);
    Tally tally;
    for (int i = 0; i < 20; ++i) {
        const SampleGrid grid{0, 0, 131, 97, 1};
        const Frame frame = random_frame(random);
        const RayMesh mesh = bowed_mesh(grid, frame, 1 + random.below(20));
        const TriangleScene scene = i % 2 == 0 ? sheets(random, frame, 1 + random.below(40))
                                               : bumpy_room(frame, 1 + random.below(12));
        compare_in_order({scene, mesh, grid, rasterize_facets(mesh, grid)}, tally);
    }
    CHECK(tally.different == 0);
    CHECK(tally.seen > 100000);
}

TEST_CASE("the vector engine draws the plain engine's bits where rays that meet see a tiny triangle",
          "[projector][oracle][many]") {
    for (const std::string& set : kernel_instruction_sets()) {
        REQUIRE(use_instruction_set(set));
        Random random(28);
        Tally tally;
        for (int i = 0; i < 60; ++i) {
            const int x0 = random.below(3000), side = 1 + i % 3;
            const SampleGrid grid{x0, 11, x0 + 180 / side, 11 + 150 / side, side};
            const Frame frame = random_frame(random);
            // How large everything is where they meet, in units of how far they come.
            const double waist = random.log_uniform(1e-10, 1e-2);
            const RayMesh mesh = film_mesh(grid, 1 + random.below(3), [&](double x, double y) {
                return Ray{frame(Vec3(x, y, 0)), frame.scale * Vec3(-(1 - waist) * x, -(1 - waist) * y, 1)};
            });
            TriangleScene scene;
            for (int k = 0; k < 1 + random.below(4); ++k) {
                const double depth = 1 + waist * random.uniform(-1, 1), lean = random.uniform(-2, 2);
                const Vec2 turn(random.uniform(-3, 3), random.uniform(-3, 3));
                const auto at = [&](double x, double y) {
                    return frame(
                        Vec3(waist * (x + turn.x * y), waist * (y + turn.y * x), depth + waist * lean * x));
                };
                add_triangle(scene, at(-4, -4), at(4, -3), at(0, 5));
            }
            compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, {}, tally);
        }
        INFO(set << " samples " << tally.samples << " seen " << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 100000);
    }
    CHECK(use_instruction_set(""));
}

// Tiles of many vectors that see one triangle or few, at every size of sample, far from the world's origin
// and from the triangles, near planes seen edge-on, and slivers over the whole film.
TEST_CASE("the vector engine draws the plain engine's bits for hits that doubles can hardly tell",
          "[projector][oracle]") {
    for (const std::string& set : kernel_instruction_sets()) {
        REQUIRE(use_instruction_set(set));
        Random random(27);
        Tally tally;
        for (int i = 0; i < 72; ++i) {
            const int x0 = random.below(3000), side = 1 + i % 3;
            const SampleGrid grid{x0, 11, x0 + 120 / side, 11 + 90 / side, side};
            Frame frame = random_frame(random);
            if (i % 4 == 0) frame.offset = random.in_cube(random.log_uniform(1, 1e7));
            const RayMesh mesh = i % 5 < 3 ? bowed_mesh(grid, frame, 1 + random.below(4))
                                           : random_facet(random, grid, frame, static_cast<Rays>(i % 5),
                                                          static_cast<Screen>(i / 5 % 4));
            TriangleScene scene = i % 3 == 0 ? bumpy_room(frame, 1 + random.below(3)) : TriangleScene{};
            for (int k = 0; k < 1 + random.below(6); ++k) {
                // Small near the rays, or large and far; leaning until they are seen edge-on.
                const double far = random.log_uniform(1e-3, 1e5), lean = random.log_uniform(1e-12, 1);
                const Vec3 tilt = far * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), 0) / lean;
                const double thin = random.log_uniform(1e-9, 1);
                const auto at = [&](double x, double y) {
                    return frame(
                        Vec3(3 * far * x, 3 * far * y * thin, far + (tilt.x * x + tilt.y * y) * thin));
                };
                add_triangle(scene, at(-1, -1), at(1.1, -1), at(0, 1.2));
                if (k % 2 == 0) add_triangle(scene, at(-1, -1), at(0, 1.2), at(-2, 3));
            }
            compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, {}, tally);
        }
        INFO(set << " samples " << tally.samples << " seen " << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 100000);
    }
    CHECK(use_instruction_set(""));
}

TEST_CASE("the vector engine draws the plain engine's bits, for rays and screens of every kind",
          "[projector][oracle][law][many]") {
    Random random(21);
    for (const DrawOptions& way : all_ways()) {
        Tally tally;
        for (int i = 0; i < 240; ++i) {
            const int x0 = random.below(2000);
            const SampleGrid grid{x0, 7, x0 + 8 + random.below(40), 7 + 8 + random.below(40),
                                  1 + random.below(3)};
            const Frame frame = random_frame(random);
            const RayMesh mesh =
                random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
            const TriangleScene scene = random_triangles(random, frame, 1 + random.below(300));
            const bool outside = i % 7 == 0;
            compare({scene, mesh, grid, outside ? all_samples(grid) : rasterize_facets(mesh, grid)}, way,
                    tally);
        }
        INFO("mode " << static_cast<int>(way.kernel.leaf_mode) << " mixed below "
                     << (way.tiles ? way.tiles->mixed_below : 0) << " samples " << tally.samples << " seen "
                     << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 30000);
    }
}

TEST_CASE("the vector engine draws the plain engine's bits through many facets, large and small",
          "[projector][oracle]") {
    Random random(22);
    for (const DrawOptions& way : all_ways()) {
        Tally tally;
        for (const int cells : {1, 3, 9, 30}) {
            for (const int room : {1, 5, 20}) {
                const SampleGrid grid{0, 0, 131, 97, 1 + (cells + room) % 2};
                const Frame frame = random_frame(random);
                const RayMesh mesh = bowed_mesh(grid, frame, cells);
                const TriangleScene scene = bumpy_room(frame, room);
                compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, way, tally);
            }
        }
        INFO("mode " << static_cast<int>(way.kernel.leaf_mode) << " mixed below "
                     << (way.tiles ? way.tiles->mixed_below : 0));
        CHECK(tally.different == 0);
        CHECK(tally.seen == tally.samples);
    }
}

TEST_CASE("every instruction set draws the same bits", "[projector][law][many]") {
    const std::vector<std::string> sets = kernel_instruction_sets();
    REQUIRE(!sets.empty());
    CHECK_FALSE(use_instruction_set("none of them"));
    Random random(23);
    const SampleGrid grid{0, 0, 160, 120, 1};
    for (const std::string& set : sets) {
        REQUIRE(use_instruction_set(set));
        Tally tally;
        for (const DrawOptions& way : all_ways()) {
            const Frame frame = random_frame(random);
            const RayMesh mesh = bowed_mesh(grid, frame, 8);
            const TriangleScene scene = random_triangles(random, frame, 2000);
            compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, way, tally);
        }
        INFO(set);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 10000);
    }
    CHECK(use_instruction_set(""));
}

TEST_CASE(
    "no wrong pixel: slivers, needles, coincident and edge-on triangles, far coordinates and all scales",
    "[projector][law][many]") {
    Random random(24);
    for (const DrawOptions& way : all_ways()) {
        Tally tally;
        for (int i = 0; i < 120; ++i) {
            const SampleGrid grid{0, 0, 48, 40, 1};
            Frame frame = random_frame(random);
            if (i % 3 == 0) frame.offset = random.in_cube(1e6);
            const RayMesh mesh = i % 2 == 0 ? bowed_mesh(grid, frame, 1 + random.below(12))
                                            : random_facet(random, grid, frame, static_cast<Rays>(i % 5),
                                                           static_cast<Screen>(i / 5 % 4));
            TriangleScene scene;
            for (int k = 0; k < 60; ++k) {
                // Slivers, needles and specks, some through the rays' origins; each twice, turned.
                const Vec3 a = random.in_cube(3);
                const Vec3 b = a + random.in_cube(random.log_uniform(1e-6, 100));
                const Vec3 c =
                    a + random.uniform(-1, 2) * (b - a) + random.in_cube(random.log_uniform(1e-14, 100));
                add_triangle(scene, frame(a), frame(b), frame(k % 5 == 0 ? a : c));
                add_triangle(scene, frame(b), frame(a), frame(k % 5 == 0 ? a : c));
                scene.object.back() = static_cast<Id>(random.below(3));
                // Planes seen edge-on or nearly so, and sheets a hair behind one another.
                const double z = random.uniform(0.5, 6), hair = random.log_uniform(1e-12, 1e-2);
                for (const double depth : {z, z * (1 + hair)})
                    add_triangle(scene, frame(Vec3(-4, -3, depth)), frame(Vec3(5, -2, depth)),
                                 frame(Vec3(0, 6, depth)));
                const double lean = random.log_uniform(1e-12, 1);
                add_triangle(scene, frame(Vec3(0, -4, 0)), frame(Vec3(lean, 4, 0)), frame(Vec3(0, 0, 9)));
            }
            compare({scene, mesh, grid, rasterize_facets(mesh, grid)}, way, tally);
        }
        INFO("mode " << static_cast<int>(way.kernel.leaf_mode) << " mixed below "
                     << (way.tiles ? way.tiles->mixed_below : 0) << " samples " << tally.samples << " seen "
                     << tally.seen);
        CHECK(tally.different == 0);
        CHECK(tally.seen > 50000);
    }
}
