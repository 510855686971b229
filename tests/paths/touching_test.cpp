// Optics that touch exactly: each surface is met once, whatever rounding says.
#include <algorithm>
#include <cmath>

#include "intersect/random_scene.h"
#include "paths/bodies.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kUpper = 1.5, kLower = 1.33;

/// The plane in which two slabs touch: no number that rounding leaves alone.
constexpr double kTouch = 1.0 / 3;

struct TwoSlabs {
    Stage stage;
    Id upper = kNone, lower = kNone;

    TwoSlabs(bool upper_first, int upper_priority, double lower_ior) {
        const auto add_upper = [&] {
            upper = stage.add_body(make_box({-9, kTouch, -9}, {9, 0.7, 9}), glass_of(kUpper), upper_priority);
        };
        if (upper_first) add_upper();
        lower = stage.add_body(make_box({-9, -0.4, -9}, {9, kTouch, 9}), glass_of(lower_ior));
        if (!upper_first) add_upper();
    }
};

/// The segments without a reflection, in order.
std::vector<PathSegment> straight_through(const FollowedPaths& paths) {
    std::vector<PathSegment> found;
    for (std::size_t s = 0; s < paths.segments.size(); ++s) {
        bool reflects = false;
        for (const Step& step : steps_to(paths.segments, static_cast<Id>(s)))
            reflects |= step.event == Event::kReflect;
        if (!reflects) found.push_back(paths.segments[s]);
    }
    return found;
}

}  // namespace

TEST_CASE("light goes from one body into another that touches it as if no air lay between", "[paths][law]") {
    Random random(81);
    for (const bool upper_first : {true, false})
        for (const int priority : {-1, 0, 1}) {
            const TwoSlabs slabs(upper_first, priority, kLower);
            for (int i = 0; i < 200; ++i) {
                const Vec3 from(random.uniform(-1, 1), random.uniform(1, 3), random.uniform(-1, 1));
                const Vec3 towards(random.uniform(-3, 3), kTouch, random.uniform(-3, 3));
                const auto paths = slabs.stage.follow(from, towards - from);
                REQUIRE(paths);
                CHECK(paths->cut.lost == Vec3(0));
                const auto way = straight_through(*paths);
                // Into the upper slab; out of it and into the lower one, once as an interface and once with
                // none; out.
                REQUIRE(way.size() == 4);
                int interfaces = 0;
                for (const std::size_t s : {1u, 2u}) interfaces += way[s].step.event == Event::kTransmit;
                CHECK(interfaces == 1);
                CHECK(way[1].next < 1e-9);
                CHECK(way[2].medium == slabs.lower);
                const Vec3 entered = normalize(towards - from);
                const double sine = std::hypot(entered.x, entered.z);
                for (const auto& [segment, ior] : {std::pair(0, kUpper), {2, kLower}, {3, 1.0}}) {
                    const Vec3& d = way[static_cast<std::size_t>(segment)].ray.direction;
                    CHECK(std::hypot(d.x, d.z) == Approx(sine / ior).margin(1e-12));
                }
            }
        }
}

TEST_CASE("two touching bodies of one glass are one: light passes, and nothing is reflected between",
          "[paths][law]") {
    Random random(82);
    const TwoSlabs slabs(true, 0, kUpper);
    for (int i = 0; i < 200; ++i) {
        const Vec3 from(random.uniform(-1, 1), 2, random.uniform(-1, 1));
        const auto paths =
            slabs.stage.follow(from, Vec3(random.uniform(-3, 3), kTouch, random.uniform(-3, 3)) - from);
        REQUIRE(paths);
        const auto way = straight_through(*paths);
        REQUIRE(way.size() == 4);
        CHECK(length(way[0].ray.direction - way[2].ray.direction) < 1e-12);
    }
}

TEST_CASE("glass that lies on a mirror: light is mirrored in the glass, and comes out as it went in",
          "[paths]") {
    Random random(83);
    for (const bool glass_first : {true, false}) {
        Stage stage;
        const auto add_glass = [&] {
            stage.add_body(make_box({-9, kTouch, -9}, {9, 0.7, 9}), glass_of(kUpper));
        };
        if (glass_first) add_glass();
        stage.add_body(make_box({-9, -1, -9}, {9, kTouch, 9}), mirror_of());
        if (!glass_first) add_glass();
        const Id glass = glass_first ? 0 : 1, mirror = 1 - glass;
        for (int i = 0; i < 300; ++i) {
            const Vec3 from(random.uniform(-1, 1), random.uniform(1, 3), random.uniform(-1, 1));
            const Vec3 direction = Vec3(random.uniform(-2, 2), kTouch, random.uniform(-2, 2)) - from;
            const auto paths = stage.follow(from, direction);
            REQUIRE(paths);
            const PathSegment* out = end_with(
                *paths, {{glass, Event::kTransmit}, {mirror, Event::kReflect}, {glass, Event::kTransmit}});
            REQUIRE(out);
            CHECK(length(out->ray.direction - normalize(direction * Vec3(1, -1, 1))) < 1e-12);
        }
    }
}

TEST_CASE("bodies whose faces fall together have one interface there, that of the one that is inside",
          "[paths][law]") {
    // A tank that is filled to its brim, from above: air meets water; from below: water meets air.
    const double brim = kTouch, shares_of_glass = std::pow((kUpper - 1) / (kUpper + 1), 2),
                 share_of_water = std::pow((kLower - 1) / (kLower + 1), 2);
    Random random(86);
    for (const bool tank_first : {true, false})
        for (const bool filled : {true, false}) {
            Stage stage;
            const auto add_tank = [&] {
                return stage.add_body(make_box({-9, -0.9, -9}, {9, brim, 9}), glass_of(kUpper), 0);
            };
            Id tank = tank_first ? add_tank() : kNone;
            const Id water =
                stage.add_body(make_box({-8, -0.4, -8}, {8, brim, 8}), glass_of(kLower), filled ? 1 : -1);
            if (!tank_first) tank = add_tank();
            const Id inside = filled ? water : tank;
            for (int i = 0; i < 200; ++i) {
                const Vec3 from(random.uniform(-1, 1), random.uniform(1, 3), random.uniform(-1, 1));
                const auto paths = stage.follow(from, Vec3(0, -1, 0));
                REQUIRE(paths);
                double reflected = 0;
                int above = 0;
                for (const PathSegment& segment : paths->segments)
                    if (segment.ray.direction.y > 0 && segment.way < from.y - brim + 1e-6) {
                        ++above;
                        reflected += segment.first_weight.y * segment.weight.y;
                    }
                CHECK(above == 1);
                CHECK(reflected == Approx(filled ? share_of_water : shares_of_glass).epsilon(1e-9));
                const auto way = straight_through(*paths);
                REQUIRE(way.size() >= 2);
                CHECK(way[1].medium == inside);
                CHECK(way[1].way == Approx(from.y - brim).margin(1e-6));
            }
        }
}

TEST_CASE("a table under a slab that lies on it is seen through the slab by every ray", "[paths][law]") {
    Stage stage;
    stage.add_body(make_box({-9, kTouch, -9}, {9, 0.7, 9}), glass_of(kUpper));
    TriangleScene table;
    table.points = {{-9, kTouch, -9}, {9, kTouch, -9}, {9, kTouch, 9}, {-9, kTouch, 9}};
    add_triangle(table, {0, 2, 1}, 0, 0);
    add_triangle(table, {0, 3, 2}, 0, 1);
    const Tracer tracer(table);
    Random random(84);
    for (int i = 0; i < 300; ++i) {
        const Vec3 from(random.uniform(-1, 1), random.uniform(1, 3), random.uniform(-1, 1));
        const Vec3 direction = normalize(Vec3(random.uniform(-2, 2), kTouch, random.uniform(-2, 2)) - from);
        const auto first = next_optic(stage.world, {{from, direction}});
        REQUIRE(first);
        const FollowedPaths paths =
            follow_paths(stage.world, {first->meeting, first->distance}, {.objects = &tracer});
        const PathSegment* end = end_with(paths, through({0}));
        REQUIRE(end);
        REQUIRE(end->hit.seen());
        CHECK(end->ray.origin.y + end->hit.t * end->ray.direction.y == Approx(kTouch).margin(1e-12));
    }
}

TEST_CASE("paths that come to a third place where a body lies on an object end there, and no others do",
          "[paths][law]") {
    // A slab between two tables; the upper one leaves half of it open.
    Stage stage;
    const double top = 0.7;
    stage.add_body(make_box({-9, kTouch, -9}, {9, top, 9}), glass_of(kUpper));
    TriangleScene tables;
    tables.points = {{-9, kTouch, -9}, {9, kTouch, -9}, {9, kTouch, 9}, {-9, kTouch, 9},
                     {-9, top, -9},    {0, top, -9},    {0, top, 9},    {-9, top, 9}};
    for (const Id first : {0u, 4u}) {
        add_triangle(tables, {first, first + 2, first + 1}, first / 4, 0);
        add_triangle(tables, {first, first + 3, first + 2}, first / 4, 1);
    }
    const Tracer tracer(tables);
    stage.world.objects = &tracer;
    stage.world.max_depth = 6;
    Random random(85);
    int under_table = 0, in_the_open = 0;
    for (int i = 0; i < 300; ++i) {
        const Vec3 from(random.uniform(0.5, 1.5), random.uniform(1, 3), random.uniform(-1, 1));
        const Vec3 direction =
            normalize(Vec3(from.x + random.uniform(-2, -0.2), kTouch, random.uniform(-2, 2)) - from);
        const auto paths = stage.follow(from, direction);
        REQUIRE(paths);
        const Vec3 first_on_top = from + (top - from.y) / direction.y * direction;
        if (first_on_top.x < 0.01) continue;
        // In, back up from the first table, there under the other or in the open, and down once more.
        const std::vector<Step> up{{0, Event::kTransmit}, {0, Event::kReflect}},
            down{{0, Event::kTransmit}, {0, Event::kReflect}, {0, Event::kReflect}};
        for (std::size_t s = 0; s < paths->segments.size(); ++s) {
            const PathSegment& segment = paths->segments[s];
            const std::vector<Step> steps = steps_to(paths->segments, static_cast<Id>(s));
            if (steps == through({0}) || steps == up) CHECK_FALSE(segment.ends);
            if (steps != down) continue;
            const bool under = segment.ray.origin.x < 0;
            ++(under ? under_table : in_the_open);
            CHECK(segment.ends == under);
        }
    }
    CHECK(under_table > 20);
    CHECK(in_the_open > 20);
}
