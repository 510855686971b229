// Laws of interface meshes: Snell at every corner on the side that its facet is seen from.
#include "refract/refraction.h"

#include "camera/pinhole.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

bool from_back(const SurfaceGrid& grid, std::size_t facet, const Vec3& eye) {
    const IdTriple& corner = grid.facets[facet];
    const Vec3 &a = grid.points[grid.corner_point[corner[0]]], &b = grid.points[grid.corner_point[corner[1]]];
    const Vec3& c = grid.points[grid.corner_point[corner[2]]];
    return triple(a - eye, b - eye, c - eye) > 0;
}

}  // namespace

TEST_CASE("every corner obeys Snell's law on its facet's side, and keeps the eye's distance as length",
          "[refract][oracle][law]") {
    Draw draw(31);
    std::size_t bent = 0, grazing = 0, total = 0;
    for (int round = 0; round < 60; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4), ior = draw.uniform(0.6, 2.5);
        const CubeSphere sphere(size * draw.in_cube(1), size);
        const bool inside = round % 2 == 1;
        const Vec3 eye = sphere.center + size * draw.away(inside ? 0.0 : 1.3, inside ? 0.9 : 6);
        const SurfaceGrid grid = regular_grid(sphere, 5);
        const RayMesh mesh = make_refraction(grid, pinhole(eye), ior);
        REQUIRE(mesh.facets.size() == grid.facets.size());
        REQUIRE(mesh.screen.size() == mesh.rays.size());
        for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
            const bool back = from_back(grid, f, eye);
            const double eta = back ? ior : 1 / ior;
            bool reflects_totally = false;
            for (std::size_t k = 0; k < 3; ++k) {
                const Id corner = grid.facets[f][k];
                const Vec3& point = grid.points[corner];
                const Vec3 in = normalize(point - eye), n = (back ? -1.0 : 1.0) * grid.corner_normal[corner];
                const double sine = length(cross(in, n));
                const bool beyond = dot(in, n) > 0;
                if (eta * (beyond ? 1 : sine) > 1) reflects_totally = true, ++total;
                if (!mesh.has_rays(f)) continue;

                const Ray& ray = mesh.rays[mesh.facets[f][k]];
                CHECK((mesh.facets[f][k] < grid.corner_point.size()) == !back);
                CHECK(ray.origin == point);
                CHECK(mesh.screen[mesh.facets[f][k]] == screen_from_world(pinhole(eye), point));
                CHECK(length(ray.direction) == Approx(length(point - eye)).epsilon(1e-13));
                const Vec3 out = normalize(ray.direction);
                if (beyond) {
                    ++grazing;
                } else {
                    ++bent;
                    CHECK(dot(out, n) < 1e-12);
                    CHECK(length(cross(out, n) - eta * cross(in, n)) < 1e-12);
                }
            }
            CHECK(mesh.has_rays(f) == !reflects_totally);
        }
    }
    CHECK(bent > 10000);
    CHECK(grazing > 100);
    CHECK(total > 100);
}

TEST_CASE("index one bends nothing: every ray goes on from the eye", "[refract][law]") {
    const CubeSphere sphere({0.2, 0.3, 0.1}, 1);
    const Vec3 eye(0.5, -1, 5);
    const SurfaceGrid grid = regular_grid(sphere, 6);
    const RayMesh mesh = make_refraction(grid, pinhole(eye), 1);
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        if (!mesh.has_rays(f)) continue;
        for (const Id corner : mesh.facets[f]) {
            const Ray& ray = mesh.rays[corner];
            const Id original = corner < grid.corner_point.size() ? corner : kNone;
            const bool turned_away =
                original != kNone && dot(ray.origin - eye, grid.corner_normal[original]) > 0;
            if (original == kNone || turned_away) continue;
            CHECK(length(ray.origin - ray.direction - eye) < 1e-13);
        }
    }
}

TEST_CASE("a corner of facets on both sides has one ray for each; unneeded back corners are not made",
          "[refract]") {
    const Patch plane(Vec3(0), 1, 0);
    const SurfaceGrid grid = regular_grid(plane, 4);
    const RayMesh above = make_refraction(grid, pinhole({0, 0, 3}), 1.5);
    CHECK(above.rays.size() == grid.corner_point.size());
    const RayMesh below = make_refraction(grid, pinhole({0, 0, -30}), 1.5);
    CHECK(below.rays.size() == 2 * grid.corner_point.size());
    for (std::size_t f = 0; f < grid.facets.size(); ++f) CHECK(below.has_rays(f));

    const CubeSphere sphere(Vec3(0), 1);
    const SurfaceGrid ball = regular_grid(sphere, 8);
    const RayMesh mesh = make_refraction(ball, pinhole({0, 0, 4}), 1.5);
    CHECK(mesh.rays.size() > ball.corner_point.size());
    CHECK(mesh.rays.size() < 2 * ball.corner_point.size());
}

TEST_CASE("from under water all but Snell's window is total reflection", "[refract][oracle]") {
    const Patch surface(Vec3(0), 4, 0);
    const SurfaceGrid grid = regular_grid(surface, 40);
    const double ior = 1.33, depth = 1;
    const RayMesh mesh = make_refraction(grid, pinhole({0, 0, -depth}), ior);
    const double window = depth / std::sqrt(ior * ior - 1);  // tan of the critical angle
    std::size_t dark = 0;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        double farthest = 0;
        for (const Id corner : grid.facets[f]) farthest = std::fmax(farthest, length(grid.points[corner]));
        CHECK(mesh.has_rays(f) == (farthest < window));
        dark += !mesh.has_rays(f);
    }
    CHECK(dark > 0);
    CHECK(dark < mesh.facets.size());
}

TEST_CASE("facets whose corner has no normal have no rays", "[refract][law]") {
    const Patch plane(Vec3(0), 1, 0);
    SurfaceGrid grid = regular_grid(plane, 2);
    grid.corner_normal[4] = Vec3(0);
    for (const double side : {1.0, -1.0}) {
        const RayMesh mesh = make_refraction(grid, pinhole({0, 0, side * 20}), 1.5);
        for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
            const IdTriple& corner = grid.facets[f];
            CHECK(mesh.has_rays(f) == (corner[0] != 4 && corner[1] != 4 && corner[2] != 4));
        }
    }
}
