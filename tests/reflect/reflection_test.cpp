// Laws of mirror meshes: flat mirrors have a virtual eye, paraboloids a focus, spheres converge with order
// two.
#include "reflect/reflection.h"

#include "camera/pinhole.h"
#include "support/draw.h"
#include "support/test.h"
#include "support/test_surfaces.h"

using namespace trilens_test;

namespace {

LinearCamera parallel_along(const Vec3& direction) {
    LinearCamera camera;
    camera.parallel = true;
    camera.view_direction = direction;
    camera.screen_x = Vec4(1, 0, 0, 0);
    camera.screen_y = Vec4(0, -1, 0, 0);
    camera.screen_w = Vec4(0, 0, 0, 1);
    return camera;
}

/// The largest angle between interpolated and exact reflected rays at the middles of the facets seen from the
/// front.
double largest_angle_error(const CubeSphere& sphere, const LinearCamera& camera, int n) {
    const SurfaceGrid grid = regular_grid(sphere, n);
    const RayMesh mesh = make_reflection(grid, camera);
    double largest = 0;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const Ray ray = interpolated_ray(mesh, f, Vec3(1.0 / 3));
        const Vec3 toward = normalize(ray.origin - camera.eye), at = ray.origin - sphere.center;
        if (dot(toward, normalize(at)) > -0.5) continue;  // not near the silhouette
        // The exact hit of the ray that the facet's middle is seen by.
        const Vec3 from = camera.eye - sphere.center;
        const double b = dot(from, toward), c = dot(from, from) - sphere.radius * sphere.radius;
        const Vec3 normal = normalize(from + (-b - std::sqrt(b * b - c)) * toward);
        const Vec3 exact = toward - 2.0 * dot(toward, normal) * normal;
        largest = std::fmax(largest, length(cross(exact, normalize(ray.direction))));
    }
    return largest;
}

}  // namespace

TEST_CASE("all rays of a flat mirror meet in the virtual eye at t = -1", "[reflect]") {
    Draw draw(21);
    for (int round = 0; round < 300; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const Patch plane(size * draw.in_cube(1), size, 0);
        const Vec3 eye = plane.center + size * draw.in_cube(3);
        const LinearCamera camera = pinhole(eye);
        const RayMesh mesh = make_reflection(regular_grid(plane, 3), camera);
        const Vec3 virtual_eye(eye.x, eye.y, 2 * plane.center.z - eye.z);
        for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
            REQUIRE(mesh.has_rays(f));
            const Ray ray = interpolated_ray(mesh, f, draw.weights());
            CHECK(length(ray.origin - ray.direction - virtual_eye) < 1e-14 * size);
        }
    }
}

TEST_CASE("corners and facets of the mesh are those of the grid", "[reflect]") {
    Draw draw(22);
    const CubeSphere sphere({0.3, 0.1, -0.2}, 1.2);
    const SurfaceGrid grid = regular_grid(sphere, 4);
    const LinearCamera camera = pinhole({1, 2, 6});
    const RayMesh mesh = make_reflection(grid, camera);
    CHECK(mesh.facets == grid.facets);
    REQUIRE(mesh.rays.size() == grid.corner_point.size());
    REQUIRE(mesh.screen.size() == grid.corner_point.size());
    for (std::size_t k = 0; k < mesh.rays.size(); ++k) {
        const Vec3& point = grid.points[grid.corner_point[k]];
        CHECK(mesh.rays[k].origin == point);
        CHECK(mesh.screen[k] == screen_from_world(camera, point));
        CHECK(length(mesh.rays[k].direction) == Approx(length(point - camera.eye)).epsilon(1e-14));
    }
}

TEST_CASE("a mirror has two sides: turning its normals changes nothing", "[reflect][law]") {
    const CubeSphere sphere({0.3, 0.1, -0.2}, 1.2);
    SurfaceGrid grid = regular_grid(sphere, 3);
    const RayMesh mesh = make_reflection(grid, pinhole({1, 2, 6}));
    for (Vec3& normal : grid.corner_normal) normal = -normal;
    const RayMesh turned = make_reflection(grid, pinhole({1, 2, 6}));
    for (std::size_t k = 0; k < mesh.rays.size(); ++k)
        CHECK(mesh.rays[k].direction == turned.rays[k].direction);
}

TEST_CASE("parallel rays along a paraboloid's axis leave it through the focus", "[reflect]") {
    for (const double bend : {0.05, 0.5, 3.0}) {
        const Patch bowl({0.5, -0.2, 0.1}, 1, bend);
        const Vec3 focus = bowl.center + Vec3(0, 0, 1 / (4 * bend));
        const SurfaceGrid grid = regular_grid(bowl, 6);
        const RayMesh mesh = make_reflection(grid, parallel_along({0, 0, -1}));
        for (const Ray& ray : mesh.rays) {
            CHECK(length(ray.direction) == Approx(1).epsilon(1e-14));
            CHECK(length(cross(focus - ray.origin, ray.direction)) <
                  1e-14 * (1 + length(focus - ray.origin)));
            CHECK(dot(focus - ray.origin, ray.direction) > 0);
        }
    }
}

TEST_CASE("a curved mirror's interpolated rays converge with order two", "[reflect][law]") {
    const CubeSphere sphere(Vec3(0), 1);
    const LinearCamera camera = pinhole({0.4, 0.7, 3.1});
    const double coarse = largest_angle_error(sphere, camera, 8),
                 fine = largest_angle_error(sphere, camera, 32);
    CHECK(coarse < 0.2);
    CHECK(coarse / fine > 11);  // 16 in the limit
    CHECK(coarse / fine < 22);
}

TEST_CASE("facets without a normal, or at the eye, have no rays; their neighbours do", "[reflect][law]") {
    const Patch plane(Vec3(0), 1, 0);
    SurfaceGrid grid = regular_grid(plane, 4);
    const Id lost = 12;  // the middle corner, of six facets
    SECTION("no normal") {
        grid.corner_normal[lost] = Vec3(0);
    }
    SECTION("the eye lies on the corner") {}
    const bool at_eye = grid.corner_normal[lost] != Vec3(0);
    const RayMesh mesh = make_reflection(grid, pinhole(at_eye ? grid.points[lost] : Vec3(0.1, 0.2, 3)));
    REQUIRE(mesh.facets.size() == grid.facets.size());
    int without = 0;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const IdTriple& corner = grid.facets[f];
        const bool touches = corner[0] == lost || corner[1] == lost || corner[2] == lost;
        CHECK(mesh.has_rays(f) == !touches);
        if (!mesh.has_rays(f)) ++without;
    }
    CHECK(without == 6);
}

TEST_CASE("an empty grid is an empty mesh", "[reflect]") {
    const RayMesh mesh = make_reflection({}, pinhole({0, 0, 1}));
    CHECK(mesh.rays.empty());
    CHECK(mesh.facets.empty());
}
