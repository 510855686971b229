// Laws of draw: what must not change the picture, and the degenerate zoo.
#include <algorithm>
#include <numeric>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "film_mesh.h"
#include "projector/projector.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::vector<Hit> drawn(const TriangleScene& scene, const RayMesh& mesh, const SampleGrid& grid,
                       DrawOptions options = {}) {
    std::vector<Hit> hits(grid.size());
    draw(PreparedScene(scene), mesh, rasterize_facets(mesh, grid), grid, hits, options);
    return hits;
}

bool same(const Hit& a, const Hit& b) {
    return a.triangle == b.triangle && a.t == b.t && a.barycentric == b.barycentric;
}

/// A curved mesh of cells x cells quads over the film, bulging towards -z, with rays that fan out along +z.
RayMesh curved_mesh(const SampleGrid& grid, int cells, double bulge) {
    return film_mesh(grid, cells, [&](double x, double y) {
        return Ray{Vec3(x, y, bulge * (x * x + y * y)), Vec3(bulge * x, bulge * y, 1)};
    });
}

TriangleScene permuted(const TriangleScene& scene, Random& random) {
    std::vector<std::size_t> order(scene.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::shuffle(order.begin(), order.end(), random.engine);
    TriangleScene result;
    for (const std::size_t i : order) {
        const IdTriple& t = scene.triangles[i];
        std::array<Id, 3> corner{t[0], t[1], t[2]};
        std::shuffle(corner.begin(), corner.end(), random.engine);
        add_triangle(result, scene.points[corner[0]], scene.points[corner[1]], scene.points[corner[2]]);
        result.object.back() = scene.object[i];
        result.primitive.back() = scene.primitive[i];
    }
    return result;
}

/// A square of half-width `half` at depth z, facing the rays of curved_mesh.
void add_square(TriangleScene& scene, double z, double half) {
    add_triangle(scene, {-half, -half, z}, {half, -half, z}, {half, half, z});
    add_triangle(scene, {-half, -half, z}, {half, half, z}, {-half, half, z});
}

}  // namespace

TEST_CASE("the order and winding of the scene's triangles do not matter, coincident ones included",
          "[projector][law]") {
    Random random(6);
    std::size_t compared = 0, different = 0;
    for (int i = 0; i < 60; ++i) {
        const SampleGrid grid{0, 0, 24, 24, 1};
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), Screen::kPerspective);
        TriangleScene scene = random_triangles(random, frame, 40);
        for (std::size_t k = 0; k < 20; ++k) {
            const IdTriple t = scene.triangles[k];
            add_triangle(scene, scene.points[t[1]], scene.points[t[0]], scene.points[t[2]]);
            scene.object.back() = static_cast<Id>(random.below(3));
        }
        const TriangleScene other = permuted(scene, random);
        const std::vector<Hit> a = drawn(scene, mesh, grid), b = drawn(other, mesh, grid);
        for (std::size_t s = 0; s < grid.size(); ++s) {
            const auto id = [](const TriangleScene& in, const Hit& hit) {
                return hit.seen() ? std::pair(in.object[hit.triangle], in.primitive[hit.triangle])
                                  : std::pair(kNone, kNone);
            };
            compared += a[s].seen();
            different += id(scene, a[s]) != id(other, b[s]) || a[s].t != b[s].t;
        }
    }
    CHECK(compared > 1000);
    CHECK(different == 0);
}

TEST_CASE("a chain of depths, each tied with the next, gives one answer in every order", "[projector][law]") {
    const SampleGrid grid{0, 0, 8, 8, 1};
    const RayMesh mesh = curved_mesh(grid, 1, 0);
    const std::vector<double> depth{5 * (1 + 1.4e-9), 5 * (1 + 0.7e-9), 5, 5 * (1 + 2.1e-9)};
    // The nearest is depth[2]; only depth[1] ties with it, and has the smaller primitive.
    std::vector<std::size_t> order{0, 1, 2, 3};
    do {
        TriangleScene scene;
        for (const std::size_t k : order) {
            add_triangle(scene, {-9, -9, depth[k]}, {9, -9, depth[k]}, {0, 30, depth[k]});
            scene.primitive.back() = static_cast<Id>(k);
        }
        for (const Hit& hit : drawn(scene, mesh, grid)) {
            REQUIRE(hit.seen());
            CHECK(scene.primitive[hit.triangle] == 1);
        }
    } while (std::next_permutation(order.begin(), order.end()));
}

TEST_CASE("culling changes no bit", "[projector][law]") {
    Random random(7);
    std::size_t seen = 0, different = 0;
    for (int i = 0; i < 400; ++i) {
        const SampleGrid grid{0, 0, 24, 24, 1};
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
        const TriangleScene scene = random_triangles(random, frame, 100);
        const std::vector<Hit> culled = drawn(scene, mesh, grid),
                               all = drawn(scene, mesh, grid, {.cull = false});
        for (std::size_t s = 0; s < grid.size(); ++s) {
            seen += all[s].seen();
            different += !same(culled[s], all[s]);
        }
    }
    CHECK(seen > 10000);
    CHECK(different == 0);
}

TEST_CASE("the number of threads changes no bit", "[projector][law]") {
    Random random(8);
    const SampleGrid grid{3, 5, 100, 77, 2};
    const RayMesh mesh = curved_mesh(grid, 7, 0.4);
    const TriangleScene scene = random_triangles(random, {}, 500);
    set_thread_count(1);
    const std::vector<Hit> one = drawn(scene, mesh, grid);
    set_thread_count(2);
    const std::vector<Hit> two = drawn(scene, mesh, grid);
    set_thread_count(0);
    CHECK(std::count_if(one.begin(), one.end(), [](const Hit& h) { return h.seen(); }) > 1000);
    CHECK(std::equal(one.begin(), one.end(), two.begin(), two.end(), same));
}

TEST_CASE("samples of any density are those of the facets, each once", "[projector]") {
    Random random(9);
    TriangleScene scene;
    add_square(scene, 3, 20);
    for (const int side : {1, 2, 3, 4, 8, 9}) {
        const SampleGrid grid{-2, 7, 11, 20, side};
        const RayMesh mesh = curved_mesh(grid, 3, 0.3);
        const std::vector<Hit> hits = drawn(scene, mesh, grid);
        std::size_t unseen = 0;
        for (std::size_t s = 0; s < grid.size(); ++s) unseen += !hits[s].seen();
        CHECK(unseen == 0);
    }
}

TEST_CASE("what no facet with rays owns is left alone", "[projector][oracle][law]") {
    const SampleGrid grid{0, 0, 8, 8, 1};
    RayMesh mesh = curved_mesh(grid, 1, 0);
    TriangleScene scene;
    add_square(scene, 3, 20);
    const FacetSamples owned = rasterize_facets(mesh, grid);
    mesh.facets[1] = {kNone, kNone, kNone};
    std::vector<Hit> hits(grid.size(), Hit{77, 5, Vec2(0)});
    draw(PreparedScene(scene), mesh, owned, grid, hits);
    REQUIRE(!owned.of(0).empty());
    REQUIRE(!owned.of(1).empty());
    for (const Id s : owned.of(0)) CHECK(hits[s].triangle < 2);
    for (const Id s : owned.of(1)) CHECK(hits[s].triangle == 77);
}

TEST_CASE("an empty scene is not seen, and neither are triangles without area", "[projector]") {
    const SampleGrid grid{0, 0, 16, 16, 1};
    const RayMesh mesh = curved_mesh(grid, 2, 0.2);
    TriangleScene scene;
    for (const Hit& hit : drawn(scene, mesh, grid)) CHECK_FALSE(hit.seen());

    add_triangle(scene, {0, 0, 3}, {0, 0, 3}, {0, 0, 3});
    add_triangle(scene, {-5, 0, 3}, {5, 0, 3}, {5, 0, 3});
    add_triangle(scene, {-5, -5, 3}, {0, 0, 3}, {5, 5, 3});
    add_triangle(scene, {0, 0, 1}, {0, 0, 2}, {0, 0, 3});
    for (const Hit& hit : drawn(scene, mesh, grid)) CHECK_FALSE(hit.seen());
}

TEST_CASE("a triangle through the facet shows only the part in front of it", "[projector]") {
    // A tilted square that crosses the rays' starting plane z = 0 along x = 0.
    const SampleGrid grid{0, 0, 32, 32, 1};
    const RayMesh mesh = curved_mesh(grid, 1, 0);
    TriangleScene scene;
    add_triangle(scene, {-3, -3, -3}, {3, -3, 3}, {3, 3, 3});
    add_triangle(scene, {-3, -3, -3}, {3, 3, 3}, {-3, 3, -3});
    const std::vector<Hit> hits = drawn(scene, mesh, grid);
    for (std::size_t s = 0; s < grid.size(); ++s) {
        const bool in_front = grid.position(s).x > 16;
        CHECK(hits[s].seen() == in_front);
        if (in_front) CHECK(hits[s].t == Approx(grid.position(s).x / 16 - 1).epsilon(1e-12));
    }
}

TEST_CASE("whatever the triangles, hits are finite and inside their triangle", "[projector][law]") {
    Random random(10);
    const SampleGrid grid{0, 0, 24, 24, 1};
    std::size_t seen = 0;
    for (int i = 0; i < 300; ++i) {
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
        TriangleScene scene;
        for (int k = 0; k < 30; ++k) {
            // Slivers, needles and specks, some through the rays' origins.
            const Vec3 a = random.in_cube(3);
            const Vec3 b = a + random.in_cube(random.log_uniform(1e-6, 100));
            const Vec3 on_line = a + random.uniform(-1, 2) * (b - a);
            const Vec3 c = on_line + random.in_cube(random.log_uniform(1e-14, 100));
            add_triangle(scene, frame(a), frame(b), frame(k % 5 == 0 ? a : c));
        }
        for (const Hit& hit : drawn(scene, mesh, grid)) {
            if (!hit.seen()) continue;
            ++seen;
            const Vec2 b = hit.barycentric;
            const bool good =
                std::isfinite(hit.t) && hit.t >= 0 && b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 + 1e-15;
            if (!good) FAIL("t " << hit.t << " b " << b.x << " " << b.y);
        }
    }
    CHECK(seen > 200);
}
