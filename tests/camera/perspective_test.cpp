// Laws of linear cameras: projecting a point and following the film's ray back are inverse to one another.
#include "camera/linear/linear_cameras.h"

#include "base/util/error.h"
#include "support/draw.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Draw;

namespace {

PerspectiveParams draw_camera(Draw& draw, double size) {
    PerspectiveParams params;
    params.look_at = {size * draw.in_cube(1), size * draw.in_cube(1), draw.away(1e-4, 1e4)};
    params.yfov_degrees = draw.uniform(5, 150);
    params.width = static_cast<int>(draw.uniform(1, 4000));
    params.height = static_cast<int>(draw.uniform(1, 4000));
    return params;
}

/// The film's ray through a screen position, by the facet that contains it.
Ray film_ray_at(const RayMesh& mesh, const Vec2& screen) {
    Vec3 best(-1e300);
    std::size_t facet = 0;
    for (std::size_t f = 0; f < mesh.facets.size(); ++f) {
        const FacetWeights weights = facet_weights(mesh, f);
        REQUIRE_FALSE(weights.edge_on);
        Vec3 e = weights.unnormalised(screen.x, screen.y);
        e /= e.x + e.y + e.z;
        const double worst = std::fmin(e.x, std::fmin(e.y, e.z));
        if (worst > std::fmin(best.x, std::fmin(best.y, best.z))) best = e, facet = f;
    }
    return interpolated_ray(mesh, facet, best);
}

/// The largest of: how far ray(t) misses the point, as a share of the scene's size.
double miss(const Ray& ray, double t, const Vec3& point, double size) {
    return length(ray.origin + t * ray.direction - point) / size;
}

}  // namespace

TEST_CASE("the film's ray through a point's screen position passes through the point at t = its depth",
          "[camera]") {
    Draw draw(1);
    int tested = 0;
    for (int round = 0; round < 2000; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        const PerspectiveParams params = draw_camera(draw, size);
        const LinearCamera camera = make_perspective(params);
        const RayMesh mesh = make_camera_mesh(camera, params.width, params.height);

        const Vec3 point = size * draw.in_cube(2);
        const Vec3 screen = screen_from_world(camera, point);
        if (screen.z < 0.01 * size) continue;
        const double slope = length(point - camera.eye) / screen.z;
        if (slope > 20) continue;  // far outside any film
        ++tested;
        CHECK(screen.z == Approx(dot(point - camera.eye, camera.view_direction)).epsilon(1e-12));
        const Ray ray = film_ray_at(mesh, Vec2(screen) / screen.z);
        const double film = 1 + length(Vec2(screen) / screen.z) / std::fmin(params.width, params.height);
        CHECK(miss(ray, screen.z, point, size) < 1e-12 * film * slope);
    }
    CHECK(tested > 700);
}

TEST_CASE("a camera's film spans its angle, x to the right and y down, square pixels", "[camera]") {
    PerspectiveParams params;
    params.look_at = {{0, 0, 0}, {0, 0, -1}, {0, 1, 0}};
    params.yfov_degrees = 90;
    params.width = 200;
    params.height = 100;
    const LinearCamera camera = make_perspective(params);
    auto pixel = [&](const Vec3& p) {
        const Vec3 s = screen_from_world(camera, p);
        return Vec2(s) / s.z;
    };
    CHECK(length(pixel({0, 0, -3}) - Vec2(100, 50)) < 1e-12);
    CHECK(length(pixel({0, 3, -3}) - Vec2(100, 0)) < 1e-12);
    CHECK(length(pixel({3, 0, -3}) - Vec2(150, 50)) < 1e-12);
    CHECK(screen_from_world(camera, {0, 0, 2}).z == Approx(-2));

    const RayMesh mesh = make_camera_mesh(camera, 200, 100);
    for (const Ray& ray : mesh.rays) {
        CHECK(ray.origin == Vec3(0));
        CHECK(ray.direction.z == Approx(-1));
    }
}

TEST_CASE("scaling the world leaves the picture as it was", "[camera][law]") {
    Draw draw(2);
    for (int round = 0; round < 200; ++round) {
        PerspectiveParams params = draw_camera(draw, 1);
        const Vec3 point = draw.in_cube(3);
        const Vec3 before = screen_from_world(make_perspective(params), point);
        const double scale = draw.log_uniform(1e-4, 1e4);
        params.look_at.eye *= scale;
        params.look_at.at *= scale;
        params.look_at.up *= draw.log_uniform(1e-200, 1e200);
        const Vec3 after = screen_from_world(make_perspective(params), scale * point);
        CHECK(length(after / scale - before) <= 1e-10 * (length(before) + 1));
    }
}

TEST_CASE("a parallel camera's rays pass through the points that it projects", "[camera]") {
    Draw draw(3);
    for (int round = 0; round < 500; ++round) {
        const double size = draw.log_uniform(1e-4, 1e4);
        OrthographicParams params;
        params.look_at = draw_camera(draw, size).look_at;
        params.world_height = size * draw.uniform(0.1, 5);
        params.width = static_cast<int>(draw.uniform(1, 2000));
        const LinearCamera camera = make_orthographic(params);
        const RayMesh mesh = make_camera_mesh(camera, params.width, params.height);

        const Vec3 point = size * draw.in_cube(2);
        const Vec3 screen = screen_from_world(camera, point);
        REQUIRE(screen.z == 1);
        const double depth = dot(point - camera.eye, camera.view_direction);
        const double aspect = 1 + static_cast<double>(params.height) / params.width;
        CHECK(miss(film_ray_at(mesh, Vec2(screen)), depth, point, size) < 1e-12 * aspect);
        CHECK(incident_direction(camera, point) == camera.view_direction);
    }
    const LinearCamera camera = make_orthographic({{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}}, 4, 800, 400});
    CHECK(length(Vec2(screen_from_world(camera, {1, 2, -7})) - Vec2(500, 0)) < 1e-12);
}

TEST_CASE("cameras that cannot be are refused with their place", "[camera][bad-input]") {
    auto place_of = [](auto change) -> std::string {
        PerspectiveParams params;
        change(params);
        try {
            make_perspective(params);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return "accepted";
    };
    CHECK(place_of([](auto& p) { p.look_at.at = p.look_at.eye; }).find("lookAt") == 0);
    CHECK(place_of([](auto& p) { p.look_at.up = 3.0 * (p.look_at.at - p.look_at.eye); }).find("lookAt") == 0);
    CHECK(place_of([](auto& p) { p.look_at.up = Vec3(0); }).find("lookAt") == 0);
    CHECK(place_of([](auto& p) { p.look_at.eye.x = std::nan(""); }).find("lookAt") == 0);
    CHECK(place_of([](auto& p) { p.yfov_degrees = 180; }).find("yfov") == 0);
    CHECK(place_of([](auto& p) { p.yfov_degrees = 0; }).find("yfov") == 0);
    CHECK(place_of([](auto& p) { p.height = 0; }).find("film") == 0);
    CHECK(place_of([](auto&) {}) == "accepted");
    CHECK_THROWS_AS(make_orthographic({{}, 0, 10, 10}), InputError);
}

TEST_CASE("explicit rays become a mesh with pixels for screen positions", "[camera]") {
    const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
        directions{{0, 0, 2}, {0, 0, 1}, {1, 0, 1}};
    const std::vector<Vec2> screen{{0, 0}, {1, 0}, {0, 1}};
    const std::vector<IdTriple> triangles{{0, 1, 2}};
    const RayMesh mesh = make_ray_mesh({points, directions, screen, triangles}, 640, 480);
    REQUIRE(mesh.facets == triangles);
    CHECK(mesh.screen[1] == Vec3(640, 0, 1));
    CHECK(mesh.screen[2] == Vec3(0, 480, 1));
    CHECK(mesh.rays[0].direction == Vec3(0, 0, 2));
    CHECK(length(film_ray_at(mesh, {320, 0}).direction - Vec3(0, 0, 1.5)) < 1e-14);

    const std::vector<IdTriple> outside{{0, 1, 3}};
    const std::vector<Vec3> still{{0, 0, 2}, {0, 0, 0}, {1, 0, 1}};
    CHECK_THROWS_AS(make_ray_mesh({points, directions, screen, outside}, 640, 480), InputError);
    CHECK_THROWS_AS(make_ray_mesh({points, still, screen, triangles}, 640, 480), InputError);
    CHECK_THROWS_AS(make_ray_mesh({points, std::span(directions).first(2), screen, triangles}, 640, 480),
                    InputError);
    CHECK_THROWS_AS(make_ray_mesh({points, directions, std::span(screen).first(2), triangles}, 640, 480),
                    InputError);
}
