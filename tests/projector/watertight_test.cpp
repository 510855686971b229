// No ray slips between triangles that share an edge or a corner.
#include <array>

#include "base/raymesh/rasterize.h"
#include "base/util/parallel.h"
#include "brute_force.h"
#include "projector/projector.h"
#include "random_cases.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A closed surface around the frame's origin; every triangle has corners of its own.
TriangleScene closed_box(const Frame& frame, const Vec3& half) {
    constexpr std::array<std::array<int, 4>, 6> kFaces{
        {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}}};
    const auto corner = [&](int k) {
        return frame(half * Vec3(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
    };
    TriangleScene scene;
    for (const auto& f : kFaces) {
        add_triangle(scene, corner(f[0]), corner(f[1]), corner(f[2]));
        add_triangle(scene, corner(f[0]), corner(f[2]), corner(f[3]));
    }
    return scene;
}

TriangleScene closed_sphere(const Frame& frame, double radius, int rings, int sectors) {
    const auto point = [&](int ring, int sector) {
        const double polar = 3.14159265358979 * ring / rings,
                     turn = 6.28318530717959 * (sector % sectors) / sectors;
        if (ring == 0 || ring == rings) return frame(Vec3(0, 0, ring == 0 ? radius : -radius));
        return frame(radius * Vec3(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn),
                                   std::cos(polar)));
    };
    TriangleScene scene;
    for (int r = 0; r < rings; ++r) {
        for (int s = 0; s < sectors; ++s) {
            // At the poles one of the two has no area.
            add_triangle(scene, point(r, s), point(r + 1, s), point(r + 1, s + 1));
            add_triangle(scene, point(r + 1, s + 1), point(r, s + 1), point(r, s));
        }
    }
    return scene;
}

std::size_t missed(const PreparedScene& scene, const RayMesh& mesh, const SampleGrid& grid,
                   const FacetSamples& owned) {
    std::vector<Hit> hits(grid.size());
    draw(scene, mesh, owned, grid, hits);
    std::size_t count = 0;
    for (const Id s : owned.sample) count += !hits[s].seen();
    return count;
}

}  // namespace

TEST_CASE("every ray inside a closed box or sphere sees it", "[projector][law]") {
    Random random(4);
    const SampleGrid grid{0, 0, 16, 16, 1};
    std::size_t samples = 0, lost = 0;
    for (int i = 0; i < 3000; ++i) {
        const Frame frame = random_frame(random);
        const RayMesh mesh =
            random_facet(random, grid, frame, static_cast<Rays>(i % 5), static_cast<Screen>(i / 5 % 4));
        const double radius = random.log_uniform(8, 1e3);
        const TriangleScene scene = i % 2 == 0 ? closed_box(frame, Vec3(radius, radius * 2, radius * 1.5))
                                               : closed_sphere(frame, radius, 6, 8);
        const FacetSamples owned = rasterize_facets(mesh, grid);
        samples += owned.sample.size();
        lost += missed(PreparedScene(scene), mesh, grid, owned);
    }
    CHECK(samples > 90000);
    CHECK(lost == 0);
}

TEST_CASE("rays that run exactly along edges and through corners see the closed surface", "[projector]") {
    // A pinhole at the centre of a cube, pixels on its diagonals and its axes, at scales where nothing is a
    // power of two.
    for (const double scale : {1.0, 0.1, 1e-4 / 3, 1e4 / 7}) {
        for (const int pixels : {2, 5, 8, 15}) {
            const Frame frame{scale, Vec3(0)};
            const SampleGrid grid{0, 0, pixels, pixels, 1};
            RayMesh mesh;
            for (const Vec2 corner : {Vec2(-1, -1), Vec2(3, -1), Vec2(-1, 3)}) {
                mesh.screen.push_back({(corner + 1.0) * 0.5 * static_cast<double>(pixels), 1});
                mesh.rays.push_back({frame(Vec3(0)), Vec3(corner, 1)});
            }
            mesh.facets = {{0, 1, 2}};
            const FacetSamples owned = rasterize_facets(mesh, grid);
            REQUIRE(owned.sample.size() == grid.size());
            CHECK(missed(PreparedScene(closed_box(frame, Vec3(1))), mesh, grid, owned) == 0);
            CHECK(missed(PreparedScene(closed_sphere(frame, 1, 8, 8)), mesh, grid, owned) == 0);
        }
    }
}

TEST_CASE("around a corner that lies on a ray exactly one triangle is seen", "[projector]") {
    Random random(5);
    const SampleGrid grid{0, 0, 9, 9, 1};
    std::size_t wrong = 0, fans = 0;
    for (int i = 0; i < 1500; ++i) {
        const Frame frame = random_frame(random);
        RayMesh mesh = random_facet(random, grid, frame, static_cast<Rays>(i % 4), Screen::kPerspective);
        const FacetSamples owned = rasterize_facets(mesh, grid);
        if (owned.sample.empty()) continue;
        ++fans;

        // The fan's hub lies on a sample's ray as nearly as doubles can; its rim is a star around the ray.
        const Id sample = owned.sample[owned.sample.size() / 2];
        const RealRay ray = ray_at(mesh, 0, grid.position(sample));
        const auto vec = [](const Real3& r) { return Vec3(r[0], r[1], r[2]); };
        const Vec3 along = normalize_or_zero(vec(ray.direction));
        const Vec3 across = normalize_or_zero(cross(along, Vec3(0.3, -0.8, 0.5))), up = cross(along, across);
        const Vec3 hub = vec(ray.origin) + frame.scale * random.uniform(1, 9) * along;
        std::vector<Vec3> rim;
        const int spokes = 3 + random.below(8);
        for (int k = 0; k < spokes; ++k) {
            const double turn = 6.28318530717959 * (k + random.uniform(-0.2, 0.2)) / spokes;
            const double reach = frame.scale * random.uniform(0.2, 3), lean = random.uniform(-0.9, 0.9);
            rim.push_back(hub + reach * (std::cos(turn) * across + std::sin(turn) * up + lean * along));
        }
        int seen = 0;
        for (std::size_t k = 0; k < rim.size(); ++k) {
            TriangleScene scene;
            const std::array<Vec3, 3> corner{hub, rim[k], rim[(k + 1) % rim.size()]};
            const std::size_t turn = static_cast<std::size_t>(random.below(3));
            add_triangle(scene, corner[turn], corner[(turn + 1) % 3], corner[(turn + 2) % 3]);
            std::vector<Hit> hits(grid.size());
            draw(PreparedScene(scene), mesh, owned, grid, hits);
            seen += hits[sample].seen();
        }
        wrong += seen != 1;
    }
    CHECK(fans > 400);
    CHECK(wrong == 0);
}
