// Images over mirrors: against Alhazen's circle by bisection, against mirrored points, and derivatives
// against differences.
#include "paths/nested/mirror_chain.h"

#include <cmath>

#include "intersect/random_scene.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

MirrorChain chain_over(const Stage& stage, const Vec3& eye, const std::vector<Id>& optics) {
    MirrorChain chain{eye, {}};
    for (const Id optic : optics)
        chain.mirrors.push_back({stage.world.optics[optic].tracer, &stage.surface(optic)});
    return chain;
}

/// The point of the unit ball round the origin that mirrors `x` to `e`, by bisection of angles in their
/// plane.
Vec3 alhazen_point(const Vec3& e, const Vec3& x) {
    const Vec3 a = normalize(e), b = normalize(x);
    double low = 0, high = 1;
    for (int k = 0; k < 200; ++k) {
        const double s = 0.5 * (low + high);
        const Vec3 p = normalize((1 - s) * a + s * b);
        (dot(normalize(e - p), p) > dot(normalize(x - p), p) ? low : high) = s;
    }
    return normalize((1 - low) * a + low * b);
}

Primitive mirror_plane_at(const Vec3& center, const Vec3& axis, const Vec3& tangent) {
    Primitive plane;
    plane.center = center;
    plane.axis = normalize(axis);
    plane.tangent = normalize(tangent - dot(tangent, plane.axis) * plane.axis);
    plane.kind = PlanePrimitive{{40, 40}};
    return plane;
}

Vec3 mirrored_in(const Primitive& plane, const Vec3& p) {
    return p - 2 * dot(p - plane.center, plane.axis) * plane.axis;
}

}  // namespace

TEST_CASE("a point's image in a ball is Alhazen's", "[paths][oracle]") {
    Stage stage;
    stage.add_ball({0, 0, 0}, 1, mirror_of());
    Random random(71);
    const Vec3 eye(0.4, 0.7, 4);
    const MirrorChain chain = chain_over(stage, eye, {0});
    std::size_t found = 0;
    for (int i = 0; i < 500; ++i) {
        const Vec3 x(random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-1, 5));
        if (length(x) < 1.2) continue;
        const Vec3 exact = alhazen_point(eye, x);
        if (dot(normalize(eye - exact), exact) < 0.4) continue;  // near the rim, past which the start may lie
        const auto image = image_over(chain, x, exact + 0.05 * Vec3(random.uniform(-1, 1), 1, 0) - eye);
        INFO("x " << x.x << " " << x.y << " " << x.z << ", cosine " << dot(normalize(eye - exact), exact));
        REQUIRE(image);
        CHECK(length(image->first - exact) < 1e-8);
        CHECK(image->first_way == Approx(length(exact - eye)).epsilon(1e-9));
        CHECK(length(normalize(x - exact) - image->ray.direction) < 1e-8);
        ++found;
    }
    CHECK(found > 200);
}

TEST_CASE("flat mirrors image a point where it is mirrored to, with ray_scale 1", "[paths]") {
    Stage stage;
    const Primitive first = mirror_plane_at({0, 0, -3}, {0.05, 0.02, 1}, {1, 0, 0});
    const Primitive second = mirror_plane_at({4, 0, 0}, {-1, 0, 0.05}, {0, 1, 0});
    stage.add(make_primitive_surface(first), mirror_of());
    stage.add(make_primitive_surface(second), mirror_of());
    const Vec3 eye(-1, 0.5, 1), x(1.5, 0.2, 0);
    const auto one = image_over(chain_over(stage, eye, {0}), x, Vec3(0, 0, -1));
    REQUIRE(one);
    CHECK(length(one->eye_direction - normalize(mirrored_in(first, x) - eye)) < 1e-9);
    CHECK(one->ray_scale() == Approx(1).margin(1e-12));

    const Vec3 twice = mirrored_in(first, mirrored_in(second, x));
    const auto two = image_over(chain_over(stage, eye, {0, 1}), x, twice - eye + Vec3(0.2, -0.3, 0));
    REQUIRE(two);
    CHECK(length(two->eye_direction - normalize(twice - eye)) < 1e-9);
    CHECK(two->way + length(x - two->ray.origin) == Approx(length(twice - eye)).epsilon(1e-9));
    CHECK(two->ray_scale() == Approx(1).margin(1e-12));
}

TEST_CASE("a chain's ray turns as its derivatives say, with own normals and with differences of them",
          "[paths]") {
    Stage stage;
    stage.add_ball({-0.75, 0.1, 0}, 0.8, mirror_of());
    stage.add_ball({1, -0.2, 0.3}, 0.65, mirror_of());
    const Vec3 eye(0.35, 0.5, 3);
    Random random(74);
    for (const bool own : {true, false}) {
        MirrorChain over_one = chain_over(stage, eye, {1}), over_two = chain_over(stage, eye, {1, 0});
        for (MirrorChain* chain : {&over_one, &over_two})
            for (ChainMirror& mirror : chain->mirrors) mirror.own_normals = own;
        std::size_t compared = 0;
        for (int i = 0; i < 100; ++i) {
            // A point of the first ball that the second one shows.
            const Vec3 out(1.75 + random.uniform(-0.8, 0.8), random.uniform(-1, 0.6),
                           random.uniform(-0.3, 1));
            const Vec3 x = Vec3(-0.75, 0.1, 0) + 0.8 * normalize(out);
            const auto image = image_over(over_one, x, Vec3(0.5, -0.1, 0.7) - eye);
            REQUIRE(image);
            const auto at = chain_ray(over_two, image->eye_direction);
            REQUIRE(at);
            if (length(at->ray.origin - x) > 1e-6) continue;  // its own near side hides it
            for (std::size_t k = 0; k < 2; ++k) {
                const double step = 1e-6;
                const auto after = chain_ray(over_two, at->eye_direction + step * at->turn[k]);
                const auto before = chain_ray(over_two, at->eye_direction - step * at->turn[k]);
                REQUIRE((after && before));
                const Vec3 origin = (after->ray.origin - before->ray.origin) / (2 * step);
                const Vec3 direction = (after->ray.direction - before->ray.direction) / (2 * step);
                CHECK(length(origin - at->origin_along[k]) < 1e-3 * length(origin));
                CHECK(length(direction - at->direction_along[k]) < 1e-3 * length(direction));
                ++compared;
            }
        }
        CHECK(compared > 50);
    }
}

TEST_CASE("a ball has no image of a point in its shadow, and none is behind a mirror", "[paths][law]") {
    Stage stage;
    stage.add_ball({0, 0, 0}, 1, mirror_of());
    const MirrorChain chain = chain_over(stage, {0, 0, 4}, {0});
    for (const Vec3& x : {Vec3(0, 0, -3), Vec3(0.3, 0.1, -2), Vec3(0, 0, 0.5)})
        for (const Vec3& start : {Vec3(0, 0.1, -1), Vec3(0.2, 0, -1), Vec3(-0.1, -0.2, -1)})
            CHECK(!image_over(chain, x, start));
    CHECK(!chain_ray(chain, {0, 1, -1}));
    CHECK(!chain_ray(chain, Vec3(0)));
}
