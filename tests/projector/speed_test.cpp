// How fast the projector draws: run with the tag [bench]; checks only that the drawing is complete.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>

#include "base/parallel.h"
#include "projector/projector.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

double milliseconds(const std::function<void()>& work) {
    double best = INFINITY;
    for (int i = 0; i < 3; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(
            best,
            std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

/// A bumpy closed room, one grid of cells x cells quads on each of its six walls.
TriangleScene bumpy_room(int cells) {
    TriangleScene scene;
    const auto point = [&](int wall, int i, int j) {
        const double x = 2.0 * i / cells - 1, y = 2.0 * j / cells - 1, s = wall % 2 == 0 ? 1 : -1;
        const Vec3 p = wall < 2 ? Vec3(s, x, y) : wall < 4 ? Vec3(x, s, y) : Vec3(x, y, s);
        return 8.0 * p * (1 + 0.05 * std::sin(9 * p.x) * std::sin(7 * p.y + 1) * std::sin(8 * p.z + 2));
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

/// A mesh over the whole film: a pinhole, or the mirrored rays of a bowed surface that the pinhole sees.
RayMesh mesh_over_film(const SampleGrid& grid, int cells, bool mirror) {
    RayMesh mesh;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double x = 2.0 * i / cells - 1, y = 2.0 * j / cells - 1;
            const Vec3 eye(0, 0, -3), look = Vec3(x * 4 / 3, y, 3), bump(x * 4 / 3, y, 0.3 * (x * x + y * y));
            const Vec3 normal = normalize(Vec3(x * 0.6, y * 0.6, -1));
            const Vec3 incident = bump - eye, out = incident - 2 * dot(incident, normal) * normal;
            mesh.rays.push_back(mirror ? Ray{bump, out} : Ray{eye, look});
            mesh.screen.push_back({(x + 1) / 2 * grid.width(), (y + 1) / 2 * grid.height(), 1});
        }
    }
    const Id row = static_cast<Id>(cells + 1);
    for (Id j = 0; j + 1 < row; ++j) {
        for (Id i = 0; i + 1 < row; ++i) {
            mesh.facets.push_back({j * row + i, j * row + i + 1, (j + 1) * row + i});
            mesh.facets.push_back({j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i});
        }
    }
    return mesh;
}

}  // namespace

TEST_CASE("speed of the exact engine at 640 x 480", "[.bench]") {
    const SampleGrid grid{0, 0, 640, 480, 1};
    std::vector<Hit> hits(grid.size());
    for (const int threads : {1, 0}) {
        set_thread_count(threads);
        for (const int cells : {1, 9, 29, 91}) {
            const TriangleScene triangles = bumpy_room(cells);
            const double prepare = milliseconds([&] { PreparedScene again(triangles); });
            const PreparedScene scene(triangles);
            for (const bool mirror : {false, true}) {
                const RayMesh mesh = mesh_over_film(grid, mirror ? 22 : 1, mirror);
                FacetSamples owned;
                const double raster = milliseconds([&] { owned = rasterize_facets(mesh, grid); });
                const double time = milliseconds([&] { draw(scene, mesh, owned, grid, hits); });
                std::size_t unseen = 0;
                for (const Id s : owned.sample) unseen += !hits[s].seen();
                CHECK(unseen == 0);
                std::printf(
                    "%d threads, %6zu triangles, %4zu facets: prepare %.2f ms, rasterize %.2f ms, draw %.2f "
                    "ms\n",
                    thread_count(), triangles.size(), mesh.facets.size(), prepare, raster, time);
            }
        }
    }
    set_thread_count(0);
}
