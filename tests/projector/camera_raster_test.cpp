// Through a pinhole the projector is the ordinary rasteriser: projected triangles, edge functions, a depth
// buffer.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/raymesh/rasterize.h"
#include "projector/projector.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr int kPixels = 48;
constexpr double kFocal = 40;  // pixels

/// Two facets over the film; the eye is the world's origin, looking along +z.
RayMesh camera() {
    RayMesh mesh;
    for (const Vec2 p : {Vec2(0, 0), Vec2(kPixels, 0), Vec2(kPixels, kPixels), Vec2(0, kPixels)}) {
        mesh.screen.push_back({p, 1});
        mesh.rays.push_back({Vec3(0), Vec3((p - kPixels / 2.0) / kFocal, 1)});
    }
    mesh.facets = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

struct Pixel {
    Id triangle = kNone;
    double depth = INFINITY;
    double margin = INFINITY;  // pixels to the nearest edge of any triangle
};

/// Textbook rasterisation of triangles that lie in front of the eye.
std::vector<Pixel> rasterized(const TriangleScene& scene, const SampleGrid& grid) {
    std::vector<Pixel> pixels(grid.size());
    for (std::size_t i = 0; i < scene.size(); ++i) {
        std::array<Vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& world = scene.points[scene.triangles[i][k]];
            p[k] = {kFocal * world.x / world.z + kPixels / 2.0, kFocal * world.y / world.z + kPixels / 2.0,
                    1 / world.z};
        }
        const auto edge = [](const Vec3& a, const Vec3& b, const Vec2& x) {
            return (b.x - a.x) * (x.y - a.y) - (b.y - a.y) * (x.x - a.x);
        };
        const double area = edge(p[0], p[1], {p[2].x, p[2].y});
        for (std::size_t s = 0; s < grid.size(); ++s) {
            const Vec2 x = grid.position(s);
            const Vec3 w = Vec3(edge(p[1], p[2], x), edge(p[2], p[0], x), edge(p[0], p[1], x)) / area;
            const double least = std::min({w.x, w.y, w.z});
            pixels[s].margin = std::min(pixels[s].margin, std::fabs(least));
            if (least < 0) continue;
            const double depth = 1 / (w.x * p[0].z + w.y * p[1].z + w.z * p[2].z);
            if (depth < pixels[s].depth) {
                pixels[s].depth = depth;
                pixels[s].triangle = static_cast<Id>(i);
            }
        }
    }
    return pixels;
}

}  // namespace

TEST_CASE("through a pinhole, draw is textbook rasterisation with a depth buffer", "[projector][oracle]") {
    Random random(11);
    const SampleGrid grid{0, 0, kPixels, kPixels, 1};
    const RayMesh mesh = camera();
    const FacetSamples owned = rasterize_facets(mesh, grid);
    REQUIRE(owned.sample.size() == grid.size());
    std::size_t seen = 0, wrong = 0, marginal = 0;
    for (int i = 0; i < 40; ++i) {
        TriangleScene scene;
        for (int k = 0; k < 40; ++k) {
            const auto corner = [&] {
                const double z = random.log_uniform(0.5, 50);
                return Vec3{random.uniform(-1, 1) * z, random.uniform(-1, 1) * z, z};
            };
            const Vec3 a = corner(), b = corner(), c = corner();
            add_triangle(scene, a, b, c);
        }
        const std::vector<Pixel> expected = rasterized(scene, grid);
        std::vector<Hit> hits(grid.size());
        draw(PreparedScene(scene), mesh, owned, grid, hits);
        for (std::size_t s = 0; s < grid.size(); ++s) {
            if (expected[s].margin < 1e-9) {
                ++marginal;
                continue;
            }
            seen += hits[s].seen();
            // The rays' directions have z = 1, so t is the depth.
            if (hits[s].triangle != expected[s].triangle)
                ++wrong;
            else if (hits[s].seen() && std::fabs(hits[s].t - expected[s].depth) > 1e-9 * hits[s].t)
                ++wrong;
        }
    }
    CHECK(seen > 50000);
    CHECK(wrong == 0);
    CHECK(marginal < 10);
}
