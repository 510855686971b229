// How fast the exact engine draws, against Embree on the same interpolated rays: float packets, as a renderer
// uses it.
#include <cmath>
#include <cstdio>

#include "base/parallel.h"
#include "base/rasterize.h"
#include "intersect/packet_tracer.h"
#include "projector/projector.h"
#include "reflect/mirror.h"
#include "timing.h"

namespace {

using namespace trilens;
using trilens_bench::median_ms;

constexpr int kRepeats = 5;

void add_triangle(TriangleScene& scene, const Vec3& a, const Vec3& b, const Vec3& c) {
    const Id first = static_cast<Id>(scene.points.size());
    scene.points.insert(scene.points.end(), {a, b, c});
    scene.triangles.push_back({first, first + 1, first + 2});
    scene.primitive.push_back(static_cast<Id>(scene.object.size()));
    scene.object.push_back(0);
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
            mesh.rays.push_back(mirror ? Ray{bump, mirrored(bump - eye, normal)} : Ray{eye, look});
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

/// One line of the table. Returns how many samples see nothing, which in a closed room is a fault.
std::size_t measure(const TriangleScene& triangles, const RayMesh& mesh, const SampleGrid& grid) {
    std::vector<Hit> hits(grid.size());
    std::vector<FloatHit> float_hits(grid.size());
    FacetSamples owned;
    const double prepare = median_ms(kRepeats, [&] { PreparedScene again(triangles); });
    const double build = median_ms(kRepeats, [&] { PacketTracer again(triangles); });
    const PreparedScene scene(triangles);
    const PacketTracer tracer(triangles);
    const double raster = median_ms(kRepeats, [&] { owned = rasterize_facets(mesh, grid); });
    const double drawn = median_ms(kRepeats, [&] { draw(scene, mesh, owned, grid, hits); });
    const std::vector<RayPacket> packets = make_ray_packets(mesh, owned, grid);
    const double traced = median_ms(kRepeats, [&] { tracer.trace(packets, float_hits); });
    std::printf("%7d %9zu %7zu %9.2f %9.2f %9.2f %9.2f %9.2f %7.2f\n", thread_count(), triangles.size(),
                mesh.facets.size(), prepare, raster, drawn, build, traced, drawn / traced);
    std::size_t unseen = 0;
    for (const Id s : owned.sample) unseen += !hits[s].seen();
    return unseen;
}

}  // namespace

int main() {
    const SampleGrid grid{0, 0, 640, 480, 1};
    std::printf(
        "640 x 480, one sample each, milliseconds, medians of %d runs; Embree's rays are made beforehand\n",
        kRepeats);
    std::printf("threads triangles  facets   prepare rasterize      draw    E.build   E.trace   ratio\n");
    std::size_t unseen = 0;
    for (const int threads : {1, 0}) {
        set_thread_count(threads);
        for (const int cells : {1, 9, 29, 91})
            for (const bool mirror : {false, true})
                unseen += measure(bumpy_room(cells), mesh_over_film(grid, mirror ? 22 : 1, mirror), grid);
    }
    if (unseen > 0) std::printf("%zu samples saw nothing\n", unseen);
    return unseen == 0 ? 0 : 1;
}
