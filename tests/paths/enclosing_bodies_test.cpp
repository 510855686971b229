// Rays that start inside of bodies: which bodies those are, and where the rays go, against concentric
// spheres.
#include "intersect/random_scene.h"
#include "paths/bodies.h"
#include "paths/stage.h"
#include "paths/trace/path_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr double kGlass = 1.5, kWater = 1.33, kInner = 0.5;

/// A ray of Bouguer's constant c passes a sphere of radius r from index n to m: it is turned towards the
/// centre by this.
double turn_at(double c, double r, double n, double m) {
    return std::asin(c / (n * r)) - std::asin(c / (m * r));
}

std::vector<Id> all(const Stage& stage) {
    std::vector<Id> ids(stage.world.optics.size());
    for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = static_cast<Id>(i);
    return ids;
}

std::vector<Id> listed(const Media& media) {
    return {media.optic.begin(), media.optic.begin() + media.count};
}

/// Where the path that is refracted everywhere goes, as the angle from -z towards -x; NaN: there is none.
double ray_turned(const Stage& stage, const Ray& ray, std::size_t steps) {
    const Media around = enclosing_bodies(stage.world, all(stage), ray.origin).media;
    const auto first = next_optic(stage.world, {ray});
    REQUIRE(first.has_value());
    const FollowedPaths paths = follow_paths(stage.world, {first->meeting, first->distance, around});
    for (std::size_t s = 0; s < paths.segments.size(); ++s) {
        const PathSegment& one = paths.segments[s];
        const std::vector<Step> way = steps_to(paths.segments, static_cast<Id>(s));
        if (!one.ends || way.size() != steps || std::any_of(way.begin(), way.end(), [](const Step& step) {
                return step.event == Event::kReflect;
            }))
            continue;
        CHECK(one.medium == kNone);
        return std::atan2(-one.ray.direction.x, -one.ray.direction.z);
    }
    return std::nan("");
}

}  // namespace

TEST_CASE("from inside of a ball of glass a ray passes a ball of water as Bouguer says", "[paths][oracle]") {
    Stage stage;
    const Id glass = stage.add_ball(Vec3(0), 1, glass_of(kGlass));
    const Id water = stage.add_ball(Vec3(0), kInner, glass_of(kWater), 1);
    for (const double h : {0.0, 0.1, 0.2, 0.3, 0.4, 0.43}) {
        const double c = kGlass * h;
        const Ray between{{h, 0, 0.8}, {0, 0, -1}};
        CHECK(listed(enclosing_bodies(stage.world, all(stage), between.origin).media) ==
              std::vector<Id>{glass});
        CHECK(ray_turned(stage, between, 3) ==
              Approx(2 * turn_at(c, kInner, kGlass, kWater) + turn_at(c, 1, 1, kGlass)).margin(1e-9));

        // In the water: half the way.
        const Ray within{{h, 0, 0}, {0, 0, -1}};
        const Media both = enclosing_bodies(stage.world, all(stage), within.origin).media;
        CHECK(listed(both) == std::vector<Id>{glass, water});
        CHECK(listed(bodies_along(stage.world, all(stage), within)) == listed(both));
        const double inner = kWater * h;
        CHECK(ray_turned(stage, within, 2) ==
              Approx(turn_at(inner, kInner, kGlass, kWater) + turn_at(inner, 1, 1, kGlass)).margin(1e-9));
    }
}

TEST_CASE("the critical angle at a ball in the glass around the eye is that of the two indices", "[paths]") {
    Stage stage;
    stage.add_ball(Vec3(0), 1, glass_of(kGlass));
    const Id water = stage.add_ball(Vec3(0), kInner, glass_of(kWater), 1);
    const double critical = kInner * kWater / kGlass;
    for (const double off : {-1e-6, 1e-6}) {
        const Ray ray{{critical + off, 0, 0.8}, {0, 0, -1}};
        const auto first = next_optic(stage.world, {ray});
        REQUIRE(first->meeting.optic == water);
        const Media around = enclosing_bodies(stage.world, all(stage), ray.origin).media;
        const FollowedPaths paths = follow_paths(stage.world, {first->meeting, first->distance, around});
        const bool enters = std::any_of(
            paths.segments.begin(), paths.segments.end(),
            [](const PathSegment& one) { return one.parent == kNone && one.step.event == Event::kTransmit; });
        CHECK(enters == (off < 0));
    }
}

TEST_CASE("of two bodies around the eye the one of higher priority is active, and the other's skin is none",
          "[paths]") {
    Stage stage;
    const Id box = stage.add_body(make_box({-1, -1, -1}, {1, 1, 1}), glass_of(kGlass), 1);
    const Id ball = stage.add_ball(Vec3(0), 0.6, glass_of(kWater), 0);
    const Ray ray{{0.1, 0.05, 0.1}, normalize(Vec3(0.1, 0.2, -1))};
    const Media around = enclosing_bodies(stage.world, all(stage), ray.origin).media;
    CHECK(listed(around) == std::vector<Id>{box, ball});
    CHECK(active_medium(stage.world, around) == box);
    const auto first = next_optic(stage.world, {ray});
    REQUIRE(first->meeting.optic == ball);
    const FollowedPaths paths = follow_paths(stage.world, {first->meeting, first->distance, around});
    const PathSegment* end = end_with(paths, {{ball, Event::kPass}, {box, Event::kTransmit}});
    REQUIRE(end != nullptr);
    const double sine = length(cross(ray.direction, Vec3(0, 0, 1)));
    CHECK(length(cross(end->ray.direction, Vec3(0, 0, 1))) == Approx(kGlass * sine).margin(1e-9));
}

TEST_CASE("a place outside of bodies, in a hollow, or beside an open surface", "[paths]") {
    Stage stage;
    stage.add_ball(Vec3(0), 1, glass_of(kGlass));
    stage.add_ball({5, 0, 0}, 1, mirror_of());
    const EnclosingBodies outside = enclosing_bodies(stage.world, all(stage), {0, 0, 1.0001});
    CHECK(outside.media.count == 0);
    CHECK(outside.unsure.empty());
    CHECK(enclosing_bodies(stage.world, all(stage), {5, 0, 0}).media.count == 0);  // mirrors hold nothing

    Stage open;
    const Id sheet = open.add_body(
        FlatBody({{Vec3(-5, -5, 0), Vec3(5, -5, 0), Vec3(5, 5, 0), Vec3(-5, 5, 0)}}), glass_of(kGlass));
    const EnclosingBodies below = enclosing_bodies(open.world, all(open), {0, 0, -1});
    CHECK(below.unsure == std::vector<Id>{sheet});
    CHECK(below.media.count == 0);
}
