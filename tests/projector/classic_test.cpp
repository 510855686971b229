// Laws of the classic engine: the exact engine's picture within its tolerance, no gaps, no order of work.
#include "base/raymesh/rasterize.h"
#include "projector/classic/classic.h"

#include <algorithm>
#include <cmath>

#include "base/util/parallel.h"
#include "film_mesh.h"
#include "projector/projector.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

std::vector<Hit> drawn(const TriangleScene& scene, const RayMesh& mesh, const SampleGrid& grid,
                       const ClassicParams& params) {
    std::vector<Hit> hits(grid.size());
    draw_classic(PreparedScene(scene), mesh, rasterize_facets(mesh, grid), grid, hits, params);
    return hits;
}

std::vector<Hit> drawn_exactly(const TriangleScene& scene, const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Hit> hits(grid.size());
    draw(PreparedScene(scene), mesh, rasterize_facets(mesh, grid), grid, hits);
    return hits;
}

/// cells x cells quads over the film, bulging, with rays that fan out along +z.
RayMesh bulging_mesh(const SampleGrid& grid, int cells, double bulge) {
    return film_mesh(grid, cells, [&](double x, double y) {
        return Ray{Vec3(x, y, bulge * (x * x + y * y)), Vec3(2 * bulge * x, (bulge + x * bulge) * y, 1)};
    });
}

/// The twelve triangles of a box around the mesh.
TriangleScene closed_box(Random& random) {
    std::array<Vec3, 8> corner;
    for (std::size_t c = 0; c < 8; ++c) {
        const Vec3 jitter = random.in_cube(0.5);
        corner[c] = Vec3(c & 1 ? 4 : -4, c & 2 ? 4 : -4, c & 4 ? 6 : -4) + jitter;
    }
    constexpr std::size_t kFaces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                          {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    TriangleScene scene;
    for (const auto& f : kFaces) {
        add_triangle(scene, corner[f[0]], corner[f[1]], corner[f[2]]);
        add_triangle(scene, corner[f[0]], corner[f[2]], corner[f[3]]);
    }
    return scene;
}

std::size_t unseen(const std::vector<Hit>& hits) {
    return static_cast<std::size_t>(
        std::count_if(hits.begin(), hits.end(), [](const Hit& hit) { return !hit.seen(); }));
}

bool same_hit(const Hit& a, const Hit& b) {
    return a.triangle == b.triangle && a.t == b.t && a.barycentric == b.barycentric;
}

std::vector<Id> every_sample(const SampleGrid& grid) {
    std::vector<Id> samples(grid.size());
    for (std::size_t s = 0; s < samples.size(); ++s) samples[s] = static_cast<Id>(s);
    return samples;
}

}  // namespace

TEST_CASE("triangles of a mesh, filled one by one, hold every sample once, ties included",
          "[projector][law]") {
    Random random(21);
    for (int trial = 0; trial < 60; ++trial) {
        const SampleGrid grid{2, 3, 22, 18, 1 + trial % 3};
        const SampleRows rows = make_sample_rows(every_sample(grid), grid);
        PolygonFiller filler(rows, 1e-9);

        // Fans around a corner, often on a sample, of a polygon larger than the film; depths vary.
        const auto corner = [&](double x, double y) {
            return Vec3(x, y, 1) * (trial % 2 ? 1.0 : random.uniform(0.5, 2));
        };
        const Vec3 hub = trial % 4 < 2 ? corner(random.below(20) + 2.5, random.below(15) + 3.5)
                                       : corner(random.uniform(2, 22), random.uniform(3, 18));
        std::vector<Vec3> rim;
        const int count = 3 + random.below(9);
        for (int k = 0; k < count; ++k) {
            const double angle = 6.283185307179586 * k / count;
            rim.push_back(corner(std::round(hub.x / hub.z + 90 * std::cos(angle)) + 0.5,
                                 std::round(hub.y / hub.z + 90 * std::sin(angle)) + 0.5));
        }
        std::vector<int> held(grid.size(), 0);
        for (std::size_t k = 0; k < rim.size(); ++k) {
            filler.add({hub, rim[k], rim[(k + 1) % rim.size()]});
            filler.fill([&](std::size_t first, std::size_t end) {
                for (std::size_t place = first; place < end; ++place) ++held[rows.sample[place]];
            });
        }
        CHECK(std::all_of(held.begin(), held.end(), [](int n) { return n == 1; }));
    }
}

TEST_CASE("a triangle that goes behind the camera holds what its visible part holds", "[projector]") {
    Random random(26);
    const SampleGrid grid{0, 0, 32, 32, 1};
    const std::vector<Id> samples = every_sample(grid);
    const SampleRows rows = make_sample_rows(samples, grid);
    constexpr double kLeastDepth = 0.01;
    PolygonFiller filler(rows, kLeastDepth);
    std::size_t held_by_both = 0, wrong = 0;
    for (int trial = 0; trial < 300; ++trial) {
        Mat3 corner(0);
        for (int k = 0; k < 3; ++k) {
            const double x = random.uniform(-20, 52), y = random.uniform(-20, 52);
            corner[k] = Vec3(x, y, 1) * random.uniform(-1, 1.5);
        }
        std::vector<bool> held(grid.size(), false);
        filler.add({corner[0], corner[1], corner[2]});
        filler.fill([&](std::size_t first, std::size_t end) {
            for (std::size_t place = first; place < end; ++place) held[rows.sample[place]] = true;
        });
        // The other answer: the weights of the sample's line, all of one sign where it meets the triangle.
        for (const Id s : samples) {
            const Vec3 e = glm::inverse(corner) * Vec3(grid.position(s), 1);
            const double least = std::min({e.x, e.y, e.z}), depth = 1 / (e.x + e.y + e.z);
            const bool in_error =
                std::fabs(least) < 1e-9 * length(e) || std::fabs(depth) < 1.01 * kLeastDepth;
            const bool inside = least > 0 && depth > kLeastDepth;
            held_by_both += inside && held[s];
            wrong += !in_error && inside != held[s];
        }
    }
    CHECK(held_by_both > 10000);
    CHECK(wrong == 0);
}

TEST_CASE("with arcs the classic engine draws what the exact one draws", "[projector]") {
    Random random(22);
    std::size_t samples = 0, different = 0, off = 0;
    double worst_t = 0;
    for (int i = 0; i < 600; ++i) {
        const SampleGrid grid{0, 0, 24, 24, 1};
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 4), static_cast<Screen>(i / 4 % 3));
        const TriangleScene scene = random_triangles(random, frame, 40);
        ClassicParams params;
        params.clip = i % 2 ? Clip::kScene : Clip::kScreen;
        const std::vector<Hit> exact = drawn_exactly(scene, mesh, grid),
                               classic = drawn(scene, mesh, grid, params);
        for (std::size_t s = 0; s < grid.size(); ++s) {
            samples += exact[s].seen();
            different += exact[s].triangle != classic[s].triangle;
            if (exact[s].triangle != classic[s].triangle || !exact[s].seen()) continue;
            const double t = std::fabs(exact[s].t - classic[s].t) / std::max(exact[s].t, 1e-300);
            worst_t = std::max(worst_t, t);
            off += t > 1e-6;
        }
    }
    INFO(different << " of " << samples << " samples differ; worst t " << worst_t);
    CHECK(samples > 10000);
    CHECK(static_cast<double>(different) < 1e-3 * static_cast<double>(samples));
    CHECK(off == 0);
}

TEST_CASE("a closed box leaves no sample uncovered, however coarse its outlines", "[projector][law]") {
    Random random(23);
    for (int i = 0; i < 40; ++i) {
        const SampleGrid grid{0, 0, 48, 40, 1};
        const RayMesh mesh = bulging_mesh(grid, 1 + i % 4, random.uniform(-0.8, 0.8));
        const TriangleScene box = closed_box(random);
        REQUIRE(unseen(drawn_exactly(box, mesh, grid)) == 0);
        for (const Curves curves : {Curves::kArcs, Curves::kStraight, Curves::kTessellate, Curves::kSlices}) {
            INFO("trial " << i << ", curves " << static_cast<int>(curves));
            CHECK(unseen(drawn(box, mesh, grid, {curves, Clip::kScene, 3})) == 0);
        }
    }
}

TEST_CASE("whatever the outlines, hits are finite and inside their triangle", "[projector][law]") {
    Random random(24);
    std::size_t seen = 0;
    for (int i = 0; i < 240; ++i) {
        const SampleGrid grid{0, 0, 20, 20, 1};
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
        const TriangleScene scene = random_triangles(random, frame, 12);
        ClassicParams params;
        params.curves = static_cast<Curves>(i % 4);
        params.clip = static_cast<Clip>(i % 3);
        params.pieces = 2;
        for (const Hit& hit : drawn(scene, mesh, grid, params)) {
            if (!hit.seen()) continue;
            ++seen;
            const Vec2 b = hit.barycentric;
            const bool good =
                std::isfinite(hit.t) && hit.t >= 0 && b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 + 1e-12;
            if (!good) FAIL("trial " << i << ": t " << hit.t << " b " << b.x << " " << b.y);
        }
    }
    CHECK(seen > 1000);
}

TEST_CASE("the classic engine: the number of threads and the order of triangles change no bit",
          "[projector][law]") {
    Random random(25);
    const SampleGrid grid{3, 5, 90, 70, 2};
    const RayMesh mesh = bulging_mesh(grid, 5, 0.4);
    TriangleScene scene = random_triangles(random, {}, 100);
    const auto all_same = [](const std::vector<Hit>& a, const std::vector<Hit>& b) {
        return std::equal(a.begin(), a.end(), b.begin(), b.end(), same_hit);
    };
    for (const Curves curves : {Curves::kArcs, Curves::kSlices, Curves::kTessellate}) {
        const ClassicParams params{curves, Clip::kScene, 3};
        set_thread_count(1);
        const std::vector<Hit> one = drawn(scene, mesh, grid, params);
        set_thread_count(2);
        const std::vector<Hit> two = drawn(scene, mesh, grid, params);
        set_thread_count(0);
        CHECK(grid.size() - unseen(one) > 1000);
        CHECK(all_same(one, two));

        // The same triangles from the last to the first.
        TriangleScene turned = scene;
        std::reverse(turned.triangles.begin(), turned.triangles.end());
        std::reverse(turned.object.begin(), turned.object.end());
        std::reverse(turned.primitive.begin(), turned.primitive.end());
        std::vector<Hit> three = drawn(turned, mesh, grid, params);
        for (Hit& hit : three) {
            if (hit.seen()) hit.triangle = static_cast<Id>(scene.size() - 1 - hit.triangle);
        }
        CHECK(all_same(one, three));
    }
}
