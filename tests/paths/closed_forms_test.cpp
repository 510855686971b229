// Rays through slab, prism, ball and lenses against the formulas of optics books.
#include <algorithm>

#include "intersect/random_scene.h"
#include "paths/bodies.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kClose = 1e-9;

/// How far a point lies from a ray's line.
double off_line(const Ray& ray, const Vec3& point) {
    return length(cross(point - ray.origin, normalize(ray.direction)));
}

/// A meridional ray: at height y where it crosses the plane z = 0, `slope` its angle to the z axis, positive
/// upward; light runs to -z.
struct Meridional {
    double y = 0, angle = 0;
};

/// The ray behind a sphere through (0, vertex) with its centre at vertex - radius, by angles alone. n: index
/// before over behind. Source: the trigonometric ray trace, Welford, Aberrations of Optical Systems,
/// chapter 4.
Meridional through_sphere(const Meridional& in, double vertex, double radius, double n) {
    // Distance of the ray from the centre, positive above.
    const double z_centre = vertex - radius;
    const double height = (in.y - std::tan(in.angle) * z_centre) * std::cos(in.angle);
    const double sin_in = height / radius, sin_out = n * sin_in;
    // The normal at the hit makes the angle (in + incidence) with the axis and stays the same.
    const double angle = in.angle - std::asin(sin_in) + std::asin(sin_out);
    const double above = sin_out * radius;  // distance from the centre, behind
    const double y_at_centre = above / std::cos(angle);
    return {y_at_centre + std::tan(angle) * z_centre, angle};
}

Meridional through_plane(const Meridional& in, double z, double n) {
    const double y = in.y - std::tan(in.angle) * z;
    const double angle = std::asin(n * std::sin(in.angle));
    return {y + std::tan(angle) * z, angle};
}

/// The ray in the x-z or any other plane through the axis; `side` unit, at right angles to z.
Ray world_ray(const Meridional& ray, const Vec3& side, double from_z) {
    const Vec3 direction = std::sin(ray.angle) * side + Vec3(0, 0, -std::cos(ray.angle));
    return {(ray.y - std::tan(ray.angle) * from_z) * side + Vec3(0, 0, from_z), direction};
}

void check_lens(const CapSide& front, const CapSide& back, double n) {
    Stage stage;
    stage.world.fresnel = false;
    const Id lens = stage.add_body(Lens(front, back, 1.2), glass_of(n));
    Random random(31);
    const auto side_of = [&](const Meridional& in, const CapSide& side, double eta) {
        return side.curvature == 0 ? through_plane(in, side.vertex, eta)
                                   : through_sphere(in, side.vertex, 1 / side.curvature, eta);
    };
    int seen = 0;
    for (int i = 0; i < 500; ++i) {
        const double turn = random.uniform(0, 2 * M_PI);
        const Vec3 side(std::cos(turn), std::sin(turn), 0);
        const Meridional in{random.uniform(-0.7, 0.7), random.uniform(-0.2, 0.2)};
        const Ray ray = world_ray(in, side, 5);
        const auto paths = stage.follow(ray.origin, ray.direction);
        REQUIRE(paths.has_value());
        const PathSegment* end = end_with(*paths, through({lens, lens}));
        if (!end) continue;  // out by a wall, or reflected totally
        ++seen;
        const Meridional out = side_of(side_of(in, front, 1 / n), back, n);
        const Ray expected = world_ray(out, side, -3);
        INFO("ray at " << in.y << ", angle " << in.angle);
        CHECK(length(end->ray.direction - expected.direction) < kClose);
        CHECK(off_line(end->ray, expected.origin) < kClose);
    }
    CHECK(seen > 400);
}

}  // namespace

TEST_CASE("a slab shifts a ray by t sin(i) (1 - cos(i) / (n cos(r))) and keeps its direction",
          "[paths][oracle]") {
    Random random(32);
    for (int i = 0; i < 300; ++i) {
        const double n = random.uniform(1.1, 3), thickness = random.log_uniform(0.01, 1);
        Stage stage;
        stage.world.fresnel = false;
        const Id slab = stage.add_body(make_box({-50, -50, -thickness}, {50, 50, 0}), glass_of(n));
        const double angle = random.uniform(0, 1.5), turn = random.uniform(0, 2 * M_PI);
        const Vec3 direction(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                             -std::cos(angle));
        const Vec3 from = -direction / std::cos(angle);
        const auto paths = stage.follow(from, direction);
        REQUIRE(paths.has_value());
        const PathSegment* end = end_with(*paths, through({slab, slab}));
        REQUIRE(end != nullptr);
        CHECK(length(end->ray.direction - direction) < kClose);
        const double within = std::asin(std::sin(angle) / n);
        const double shift = thickness * std::sin(angle) * (1 - std::cos(angle) / (n * std::cos(within)));
        CHECK(off_line({from, direction}, end->ray.origin) == Approx(shift).margin(kClose));
        CHECK(end->way == Approx(1 / std::cos(angle) + thickness / std::cos(within)).epsilon(kClose));
    }
}

TEST_CASE("a prism turns a ray by i + asin(sin A sqrt(n^2 - sin^2 i) - cos A sin i) - A", "[paths][oracle]") {
    Random random(33);
    int seen = 0;
    for (int i = 0; i < 300; ++i) {
        const double n = random.uniform(1.2, 2), apex = random.uniform(0.2, 1.2);
        // The apex at the top; light comes from the left onto the left side.
        const double half = std::tan(apex / 2);
        Stage stage;
        stage.world.fresnel = false;
        const Id prism =
            stage.add_body(make_prism({Vec2(-half, -1), Vec2(half, -1), Vec2(0, 0)}, 2), glass_of(n));
        const Vec3 normal(-std::cos(apex / 2), std::sin(apex / 2), 0),
            up(std::sin(apex / 2), std::cos(apex / 2), 0);
        const double incidence = random.uniform(-0.3, 1.5);  // from below the normal
        const Vec3 direction = -std::cos(incidence) * normal + std::sin(incidence) * up;
        const Vec3 entry = -0.3 * up;
        const auto paths = stage.follow(entry - direction, direction);
        REQUIRE(paths.has_value());
        const double sin_out = std::sin(apex) * std::sqrt(n * n - std::pow(std::sin(incidence), 2)) -
                               std::cos(apex) * std::sin(incidence);
        const PathSegment* end = end_with(*paths, through({prism, prism}));
        if (sin_out >= 1) {
            CHECK(end == nullptr);
            continue;
        }
        if (!end || end->ray.origin.x <= 0) continue;  // out by the base
        ++seen;
        const double deviation = incidence + std::asin(sin_out) - apex;
        const double turned = std::atan2(dot(cross(end->ray.direction, direction), Vec3(0, 0, 1)),
                                         dot(end->ray.direction, direction));
        CHECK(turned == Approx(deviation).margin(kClose));
    }
    CHECK(seen > 100);
}

TEST_CASE("a prism turns least where light passes it symmetrically", "[paths][oracle]") {
    const double n = 1.5168, apex = M_PI / 3;
    Stage stage;
    stage.world.fresnel = false;
    const double half = std::tan(apex / 2);
    const Id prism =
        stage.add_body(make_prism({Vec2(-half, -1), Vec2(half, -1), Vec2(0, 0)}, 2), glass_of(n));
    const auto turned = [&](double incidence) {
        const Vec3 normal(-std::cos(apex / 2), std::sin(apex / 2), 0),
            up(std::sin(apex / 2), std::cos(apex / 2), 0);
        const Vec3 direction = -std::cos(incidence) * normal + std::sin(incidence) * up;
        const auto paths = stage.follow(-0.4 * up - direction, direction);
        return std::acos(dot(end_with(*paths, through({prism, prism}))->ray.direction, direction));
    };
    const double symmetric = std::asin(n * std::sin(apex / 2));
    const double least = 2 * symmetric - apex;
    CHECK(turned(symmetric) == Approx(least).margin(kClose));
    CHECK(n == Approx(std::sin((apex + least) / 2) / std::sin(apex / 2)).epsilon(kClose));
    for (const double off : {-0.2, -0.05, 0.05, 0.2}) CHECK(turned(symmetric + off) > least);
}

TEST_CASE("a ball lens of either kind of surface: where the ray leaves and whither, by angles",
          "[paths][oracle][thorough]") {
    Random random(34);
    const std::shared_ptr<const Surface> faces =
        std::make_shared<ProjectedSphere>(FaceDomain::kSquare, Vec3(0), 1);
    for (int i = 0; i < 400; ++i) {
        const double n = random.uniform(1.1, 2.5), height = random.uniform(0, 0.9999);
        Stage stage;
        const Id ball = i % 2 ? stage.add(faces, glass_of(n)) : stage.add_ball(Vec3(0), 1, glass_of(n));
        const Vec3 along = random.direction(), side = normalize(cross(along, random.direction()));
        const auto paths = stage.follow(height * side - 3.0 * along, along);
        REQUIRE(paths.has_value());
        const double in = std::asin(height), within = std::asin(height / n);
        // In the plane of the ray: the entry at the angle pi - in from `along`, then pi - 2 r on.
        const auto at = [&](double angle) { return std::cos(angle) * along + std::sin(angle) * side; };
        const double first = M_PI - in;
        for (int inner = 0; inner < 3; ++inner) {
            std::vector<Step> steps{{ball, Event::kTransmit}};
            for (int k = 0; k < inner; ++k) steps.push_back({ball, Event::kReflect});
            steps.push_back({ball, Event::kTransmit});
            const PathSegment* end = end_with(*paths, steps);
            if (!end) {
                CHECK(inner > 0);  // too faint
                break;
            }
            const double exit = first - (inner + 1) * (M_PI - 2 * within);
            CHECK(length(end->ray.origin - at(exit)) < kClose);
            CHECK(length(end->ray.direction - at(exit - in)) < kClose);
        }
    }
}

TEST_CASE("plano-convex, biconvex and meniscus lenses trace as the trigonometric ray trace has it",
          "[paths][oracle]") {
    check_lens({0.3, 1 / 2.0}, {0, 0}, 1.5);            // plano-convex, round side first
    check_lens({0.3, 0}, {0, -1 / 2.5}, 1.7);           // flat side first
    check_lens({0.4, 1 / 3.0}, {-0.1, -1 / 2.2}, 1.6);  // biconvex
    check_lens({0.5, 1 / 2.0}, {0.1, 1 / 3.5}, 1.5);    // meniscus
    check_lens({0.2, -1 / 3.0}, {-0.1, 1 / 3.0}, 1.8);  // biconcave
}

TEST_CASE("rays near the axis meet at the lensmaker's focus", "[paths][oracle]") {
    struct Case {
        CapSide front, back;
        double n;
    };
    for (const auto& [front, back, n] :
         {Case{{0.3, 1 / 2.0}, {0, 0}, 1.5}, Case{{0.4, 1 / 3.0}, {-0.1, -1 / 2.2}, 1.6},
          Case{{0.5, 1 / 2.0}, {0.1, 1 / 3.5}, 1.5}}) {
        Stage stage;
        const Id lens = stage.add_body(Lens(front, back, 1.2), glass_of(n));
        // Curvatures in the direction of light (to -z): c1 of the front, c2 of the back.
        const double c1 = front.curvature, c2 = back.curvature, d = front.vertex - back.vertex;
        const double power = (n - 1) * (c1 - c2 + (n - 1) * d * c1 * c2 / n);
        const double height = 1e-4;
        const auto paths = stage.follow({0, height, 5}, {0, 0, -1});
        const PathSegment* end = end_with(*paths, through({lens, lens}));
        REQUIRE(end != nullptr);
        const double slope = end->ray.direction.y / end->ray.direction.z;  // rises towards +z
        CHECK(height / slope == Approx(1 / power).epsilon(1e-6));
        const double focus = end->ray.origin.z - end->ray.origin.y / slope;
        CHECK(back.vertex - focus == Approx((1 - (n - 1) * d * c1 / n) / power).epsilon(1e-6));
    }
    // A ball: f = n R / (2 (n - 1)) from its centre.
    Stage stage;
    const Id ball = stage.add_ball({0, 0, 1}, 2, glass_of(1.5));
    const auto paths = stage.follow({0, 1e-4, 9}, {0, 0, -1});
    const PathSegment* end = end_with(*paths, through({ball, ball}));
    REQUIRE(end != nullptr);
    const double focus = end->ray.origin.z - end->ray.origin.y / end->ray.direction.y * end->ray.direction.z;
    CHECK(1 - focus == Approx(1.5 * 2 / (2 * 0.5)).epsilon(1e-6));
}

TEST_CASE("just below the critical angle light leaves along the surface, just above none does", "[paths]") {
    const double n = 1.5, critical = std::asin(1 / n);
    Stage stage;
    const Id slab = stage.add_body(make_box({-50, -50, -1}, {50, 50, 0}), glass_of(n));
    for (const double off : {-1e-3, -1e-6, -1e-9, 1e-9, 1e-6, 1e-3}) {
        const double angle = critical + off;
        // From inside: the camera stands in the glass.
        const auto paths = stage.follow({0, 0, -0.5}, {std::sin(angle), 0, std::cos(angle)});
        REQUIRE(paths.has_value());
        const PathSegment* out = end_with(*paths, through({slab}));
        INFO("off the critical angle by " << off);
        CHECK((out != nullptr) == (off < 0));
        if (!out) {
            CHECK(paths->segments.front().step == Step{slab, Event::kReflect});
            CHECK(paths->segments.front().principal);
            continue;
        }
        CHECK(out->ray.direction.x == Approx(std::min(1.0, n * std::sin(angle))).margin(kClose));
        CHECK(out->medium == kNone);
    }
    // From outside light comes in at every angle, at most at the critical one.
    for (const double grazing : {1e-3, 1e-6}) {
        const auto paths =
            stage.follow({-1, 0, std::tan(grazing)}, {std::cos(grazing), 0, -std::sin(grazing)});
        REQUIRE(paths.has_value());
        const auto entered = std::find_if(
            paths->segments.begin(), paths->segments.end(),
            [](const auto& one) { return one.parent == kNone && one.step.event == Event::kTransmit; });
        REQUIRE(entered != paths->segments.end());
        const double within = std::asin(entered->ray.direction.x);
        CHECK(within <= critical);
        CHECK(std::sin(within) == Approx(std::cos(grazing) / n).epsilon(kClose));
        CHECK(entered->medium == slab);
    }
}

TEST_CASE("a right-angled prism turns light by a right angle, or back, by total reflection alone",
          "[paths]") {
    Stage stage;
    const Id prism = stage.add_body(make_prism({Vec2(0, 0), Vec2(1, 0), Vec2(0, 1)}, 1), glass_of(1.5));
    // In by the left leg, at the long side, out by the bottom leg.
    const auto turned = stage.follow({-1, 0.3, 0}, {1, 0, 0});
    const PathSegment* end =
        end_with(*turned, {{prism, Event::kTransmit}, {prism, Event::kReflect}, {prism, Event::kTransmit}});
    REQUIRE(end != nullptr);
    CHECK(end->principal);
    CHECK(length(end->ray.direction - Vec3(0, -1, 0)) < kClose);
    CHECK(length(end->ray.origin - Vec3(0.7, 0, 0)) < kClose);
    CHECK(end->weight.x == Approx(0.96).epsilon(1e-12));  // nothing lost but at the exit: 1 - 0.04
    // In by the long side: back the way it came, beside it.
    const Vec3 in = -normalize(Vec3(1, 1, 0));
    const auto back = stage.follow(Vec3(0.7, 0.3, 0) - in, in);
    end = end_with(*back, {{prism, Event::kTransmit},
                           {prism, Event::kReflect},
                           {prism, Event::kReflect},
                           {prism, Event::kTransmit}});
    REQUIRE(end != nullptr);
    CHECK(length(end->ray.direction + in) < kClose);
    CHECK(length(end->ray.origin - Vec3(0.3, 0.7, 0)) < kClose);
}
