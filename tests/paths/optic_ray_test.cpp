// Secondary rays: the laws hold at exact hits, and a ball lens does what optics books say.
#include "support/closed_forms.h"

#include <cmath>

#include "intersect/limit_tracer.h"
#include "intersect/random_scene.h"
#include "intersect/test_surfaces.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

SurfaceHit hit_with(const Vec3& position, const Vec3& normal) {
    SurfaceHit hit;
    hit.point.position = position;
    hit.point.normal = normal;
    return hit;
}

}  // namespace

TEST_CASE("mirrored rays leave from the hit, keep their length and ignore which way the normal points",
          "[paths]") {
    Random random(21);
    for (int i = 0; i < 500; ++i) {
        const Vec3 position = random.in_box(5), normal = random.direction();
        const Ray incoming{random.in_box(5), random.log_uniform(1e-4, 1e4) * random.direction()};
        const Ray ray = mirrored_ray(incoming, hit_with(position, normal));
        const Ray turned = mirrored_ray(incoming, hit_with(position, -normal));
        const double size = length(incoming.direction);
        CHECK(ray.origin == position);
        CHECK(length(ray.direction - turned.direction) <= 1e-15 * size);
        CHECK(length(ray.direction) == Approx(size).epsilon(1e-14));
        CHECK(std::fabs(dot(ray.direction, normal) + dot(incoming.direction, normal)) <= 1e-14 * size);
        CHECK(length(cross(normal, ray.direction) - cross(normal, incoming.direction)) <= 1e-14 * size);
    }
}

TEST_CASE("what enters by the front leaves by the back: a parallel plate gives the direction back",
          "[paths]") {
    Random random(22);
    for (int i = 0; i < 500; ++i) {
        const double ior = random.uniform(1.01, 3);
        const Vec3 normal = random.direction();
        Ray incoming{random.in_box(1), random.log_uniform(1e-3, 1e3) * random.direction()};
        if (dot(incoming.direction, normal) > 0) incoming.direction = -incoming.direction;
        const double size = length(incoming.direction);

        const SurfaceHit front = hit_with(Vec3(0), normal), back = hit_with(Vec3(1), -normal);
        CHECK_FALSE(arrival(incoming, front).inside);
        const auto within = refracted_ray(incoming, front, ior);
        REQUIRE(within.has_value());
        CHECK(arrival(*within, back).inside);
        const auto out = refracted_ray(*within, back, ior);
        REQUIRE(out.has_value());
        CHECK(length(out->direction - incoming.direction) <=
              1e-12 * size / std::fabs(dot(incoming.direction, normal) / size));

        // Snell: sines in the ratio of the indices, the refracted ray on the other side.
        const double sin_in = length(cross(normal, incoming.direction)) / size;
        const double sin_within = length(cross(normal, within->direction)) / length(within->direction);
        CHECK(sin_in == Approx(ior * sin_within).epsilon(1e-12).margin(1e-14));
        CHECK(dot(within->direction, normal) < 0);
    }
}

TEST_CASE("beyond the critical angle nothing leaves", "[paths]") {
    const double ior = 1.5, critical = std::asin(1 / ior);
    const SurfaceHit hit = hit_with(Vec3(0), {0, 1, 0});
    const auto from_within = [](double angle) { return Ray{{}, {std::sin(angle), std::cos(angle), 0}}; };
    CHECK(refracted_ray(from_within(critical - 1e-9), hit, ior).has_value());
    CHECK_FALSE(refracted_ray(from_within(critical + 1e-9), hit, ior).has_value());
}

TEST_CASE("a ray through a glass ball is turned by twice the difference of its angles", "[paths][law]") {
    Random random(23);
    const ProjectedSphere ball(FaceDomain::kSquare, Vec3(0), 1);
    const LimitTracer tracer(ball, grid_of(ball, 16));
    for (int i = 0; i < 500; ++i) {
        const double ior = random.uniform(1.1, 2.5), height = random.uniform(0, 0.999);
        const Vec3 along = random.direction(), side = normalize(cross(along, random.direction()));
        const Ray incoming{height * side - 3.0 * along, along};
        const auto entry = tracer.first_hit(incoming);
        REQUIRE(entry.has_value());
        const auto within = refracted_ray(incoming, *entry, ior);
        REQUIRE(within.has_value());
        const auto exit = tracer.first_hit(*within, tracer.self_hit_t_min(*within));
        REQUIRE(exit.has_value());
        const auto out = refracted_ray(*within, *exit, ior);
        REQUIRE(out.has_value());

        const double angle_in = std::asin(height), angle_within = std::asin(height / ior);
        CHECK(length(exit->point.position - entry->point.position) ==
              Approx(2 * std::cos(angle_within)).epsilon(1e-11));
        const double turned = std::atan2(length(cross(along, out->direction)), dot(along, out->direction));
        CHECK(turned == Approx(2 * (angle_in - angle_within)).margin(1e-11));
        CHECK(dot(out->direction, side) <= 1e-12);  // towards the axis
    }
}

TEST_CASE("a hollow mirror sphere keeps a ray's distance from its centre over many bounces", "[paths]") {
    Random random(24);
    const ProjectedSphere ball(FaceDomain::kTriangle, Vec3(0), 1);
    const LimitTracer tracer(ball, grid_of(ball, 16));
    for (int i = 0; i < 50; ++i) {
        Ray ray{0.5 * random.direction(), random.direction()};
        const double distance = length(cross(ray.origin, ray.direction));
        for (int bounce = 0; bounce < 30; ++bounce) {
            const auto hit = tracer.first_hit(ray, bounce == 0 ? 0 : tracer.self_hit_t_min(ray));
            REQUIRE(hit.has_value());
            ray = mirrored_ray(ray, *hit);
            CHECK(length(cross(ray.origin, ray.direction)) == Approx(distance).margin(1e-11));
        }
    }
}
