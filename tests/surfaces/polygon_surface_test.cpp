// Triangles with interpolated normals, against a sphere that they stand for.
#include <cmath>
#include <random>

#include "base/util/error.h"
#include "support/test.h"
#include "surfaces/polygon_surface.h"
#include "surfaces/surfaces.h"

using namespace trilens;

namespace {

/// An octahedron whose normals are those of the sphere around it.
Cage polygon_octahedron() {
    Cage cage;
    cage.scheme = SubdivisionScheme::kUnsubdivided;
    cage.points = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    for (const int x : {0, 3})
        for (const int y : {1, 4})
            for (const int z : {2, 5}) {
                const bool turned = ((x == 3) + (y == 4) + (z == 5)) % 2 == 1;
                for (const int k : turned ? std::array{x, z, y} : std::array{x, y, z})
                    cage.face_vertex_indices.push_back(k);
                cage.face_vertex_counts.push_back(3);
            }
    for (const int k : cage.face_vertex_indices)
        cage.normals.push_back(2.0 * cage.points[static_cast<std::size_t>(k)]);
    return cage;
}

}  // namespace

TEST_CASE("a surface that is not subdivided lies on its triangles and has their corners' normals",
          "[surfaces]") {
    const Cage cage = polygon_octahedron();
    const auto surface = make_limit_surface(cage, "octahedron", {});
    REQUIRE(surface->face_count() == 8);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> share(0, 1);
    for (Id face = 0; face < 8; ++face)
        for (int i = 0; i < 50; ++i) {
            Vec2 uv(share(random), share(random));
            if (uv.x + uv.y > 1) uv = Vec2(1) - uv;
            const SurfacePoint point = surface->eval(face, uv);
            CHECK(std::abs(point.position.x) + std::abs(point.position.y) + std::abs(point.position.z) ==
                  Approx(1).epsilon(1e-12));
            // Of an octahedron the interpolated normal is the direction of the point itself.
            CHECK(length(point.normal - normalize_or_zero(point.position)) < 1e-12);
            CHECK(dot(cross(point.du, point.dv), point.normal) > 0);
            const std::optional<FaceBounds> bounds = surface->face_bounds(face);
            REQUIRE(bounds);
            CHECK(bounds->box.holds(point.position));
            CHECK(dot(bounds->normal, point.normal) >= std::cos(bounds->angle) - 1e-12);
            CHECK(bounds->angle < 1);
        }
    // Closed: every corner and side is shared, and a grid of it has no point twice.
    for (Id face = 0; face < 8; ++face)
        for (std::size_t k = 0; k < 3; ++k) {
            CHECK(surface->border(face).corners[k] != kNone);
            CHECK(surface->border(face).sides[k].edge != kNone);
        }
    const SurfaceGrid grid = make_grid(*surface, 3);
    CHECK(grid.facets.size() == 8 * 9);
    CHECK(grid.points.size() == 8 * 9 / 2 + 2);  // Euler
    CHECK(grid.corner_normal.size() == grid.points.size());
}

TEST_CASE("normals that point inward are turned to the front; without any they are the triangles' own",
          "[surfaces]") {
    Cage cage = polygon_octahedron();
    for (Vec3& normal : cage.normals) normal = -normal;
    CHECK(length(make_polygon_surface(cage, "")->eval(0, {0, 0}).normal - Vec3(1, 0, 0)) < 1e-15);
    cage.normals.clear();
    CHECK(length(make_polygon_surface(cage, "")->eval(0, {0, 0}).normal - Vec3(1 / std::sqrt(3.0))) < 1e-15);
}

TEST_CASE("what is no surface of triangles is refused", "[surfaces][bad-input]") {
    Cage cage = polygon_octahedron();
    cage.normals.pop_back();
    CHECK_THROWS_AS(make_polygon_surface(cage, "x"), InputError);
    cage = polygon_octahedron();
    cage.face_vertex_indices[4] = 6;
    CHECK_THROWS_AS(make_polygon_surface(cage, "x"), InputError);
    cage = polygon_octahedron();
    cage.face_vertex_counts[0] = 4;
    CHECK_THROWS_AS(make_polygon_surface(cage, "x"), InputError);
    cage = polygon_octahedron();
    cage.points[2].y = NAN;
    CHECK_THROWS_AS(make_polygon_surface(cage, "x"), InputError);
    Cage empty;
    empty.scheme = SubdivisionScheme::kUnsubdivided;
    CHECK_THROWS_AS(make_polygon_surface(empty, "x"), InputError);
}
