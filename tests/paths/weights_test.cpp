// How much light the ends of a ray's paths carry: nothing is lost but what is said, and absorption by length.
#include "intersect/random_scene.h"
#include "paths/bodies.h"
#include "paths/stage.h"
#include "refract/refraction.h"
#include "shade/shade.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// A few bodies that overlap one another anyhow; no two share a surface.
void fill(Stage& stage, Random& random, double dispersion) {
    const int count = 1 + static_cast<int>(random.below(4));
    for (int i = 0; i < count; ++i) {
        Material glass = glass_of(random.uniform(1.05, 2.4));
        glass.dispersion = random.below(2) ? dispersion : 0;
        const int priority = static_cast<int>(random.below(3));
        const Vec3 at = random.in_box(0.7);
        switch (random.below(4)) {
            case 0:
                stage.add_ball(at, random.uniform(0.3, 1), glass, priority);
                break;
            case 1:
                stage.add_body(make_box(at - Vec3(0.5), at + Vec3(0.4)), glass, priority);
                break;
            case 2:
                stage.add_body(Lens({0.3 + 0.01 * i, 0.4}, {-0.3 - 0.02 * i, -0.3}, 0.8 + 0.01 * i), glass,
                               priority);
                break;
            default:
                stage.add_ball(at, random.uniform(0.2, 0.5), mirror_of());
                break;
        }
    }
}

/// The light of all ends, by colour, as a picture weighs it.
Vec3 light_of_ends(const Stage& stage, const NextOptic& first, const FollowedPaths& paths) {
    const double cosine = std::fabs(dot(first.meeting.incoming, first.meeting.normal));
    const OpticWeights weights = optic_weights(*stage.world.optics[first.meeting.optic].material,
                                               {cosine, first.meeting.front}, stage.world.fresnel);
    Vec3 sum(0);
    for (const PathSegment& one : paths.segments)
        if (one.ends) sum += (one.path == Path::kReflect ? weights.reflect : weights.refract) * one.weight;
    return sum;
}

/// Follows rays through random scenes; `least` of light is followed.
void check_energy(bool fresnel, double dispersion, double least, std::uint64_t seed) {
    Random random(seed);
    int met = 0;
    double most_cut = 0;
    for (int i = 0; i < 60; ++i) {
        Stage stage;
        stage.world.fresnel = fresnel;
        stage.world.max_depth = 1 + static_cast<int>(random.below(8));
        fill(stage, random, dispersion);
        for (int k = 0; k < 10; ++k) {
            const Vec3 from = 5.0 * random.direction(), direction = normalize(random.in_box(0.8) - from);
            const auto first = next_optic(stage.world, {{from, direction}});
            const auto paths = stage.follow(from, direction, least);
            REQUIRE(first.has_value() == paths.has_value());
            if (!first) continue;
            ++met;
            const Vec3 light = light_of_ends(stage, *first, *paths);
            const Vec3 cut = paths->cut.faint + paths->cut.lost;
            most_cut = std::max(most_cut, of_worst_colour(cut));
            INFO("scene " << i << ", ray " << k << ": " << light.x << " " << light.y << " " << light.z
                          << ", cut " << cut.x << " " << cut.y << " " << cut.z);
            for (int c = 0; c < 3; ++c) {
                CHECK(light[c] <= 1 + 1e-9);
                CHECK(light[c] + cut[c] == Approx(1).epsilon(1e-9));
                CHECK(paths->cut.too_deep[c] <= 1 + 1e-9);
            }
            CHECK(paths->cut.lost == Vec3(0));
        }
    }
    CHECK(met > 200);
    CHECK((most_cut > 0) == fresnel);
}

}  // namespace

TEST_CASE("without absorption the ends of all paths, with what was cut, add up to all the light",
          "[paths][law][thorough]") {
    SECTION("Fresnel") {
        check_energy(true, 0, kLeastWeight, 41);
    }
    SECTION("Fresnel, colours apart") {
        check_energy(true, 1.5, kLeastWeight, 42);
    }
    SECTION("all of it transmitted") {
        check_energy(false, 0, kLeastWeight, 43);
    }
    SECTION("all of it transmitted, colours apart") {
        check_energy(false, 1.5, kLeastWeight, 44);
    }
    SECTION("only what is bright") {
        check_energy(true, 0, 0.05, 45);
    }
}

TEST_CASE("what is beyond the last optic that is followed is said", "[paths]") {
    Stage stage;
    stage.world.fresnel = false;
    const Id near = stage.add_body(make_box({-9, -9, -1}, {9, 9, 0}), mirror_of());
    const Id far = stage.add_body(make_box({-9, -9, 4}, {9, 9, 5}), mirror_of());
    for (const int depth : {0, 1, 5, 8}) {
        stage.world.max_depth = depth;
        const auto paths = stage.follow({0, 0, 2}, {0.02, 0, -1});
        REQUIRE(paths->segments.size() == static_cast<std::size_t>(depth) + 1);
        for (std::size_t s = 0; s < paths->segments.size(); ++s) {
            CHECK(paths->segments[s].step == Step{s % 2 ? far : near, Event::kReflect});
            CHECK(paths->segments[s].depth == s);
            CHECK(paths->segments[s].ends == (s == static_cast<std::size_t>(depth)));
        }
        CHECK(paths->cut.too_deep == Vec3(depth == 0 ? 0 : 1));  // at 0 nobody asks what lies beyond
    }
}

TEST_CASE("glass absorbs by the length of the way inside, once for every crossing", "[paths][law]") {
    Random random(46);
    for (int i = 0; i < 200; ++i) {
        Material glass = glass_of(random.uniform(1.2, 2));
        glass.attenuation_color = {0.9, 0.5, 0.2};
        glass.attenuation_distance = random.uniform(0.3, 3);
        Stage stage;
        const Id ball = stage.add_ball(Vec3(0), 1, glass);
        const double h = random.uniform(0, 0.99);
        const auto paths = stage.follow({h, 0, 3}, {0, 0, -1}, 1e-6);
        const double cos_in = std::sqrt(1 - h * h),
                     cos_within = std::sqrt(1 - h * h / (glass.ior * glass.ior));
        const double inner = fresnel_reflectance(cos_within, glass.ior);
        CHECK(inner == Approx(fresnel_reflectance(cos_in, 1 / glass.ior)).epsilon(1e-9));
        for (int crossings = 1; crossings < 4; ++crossings) {
            std::vector<Step> steps{{ball, Event::kTransmit}};
            for (int k = 1; k < crossings; ++k) steps.push_back({ball, Event::kReflect});
            steps.push_back({ball, Event::kTransmit});
            const PathSegment* end = end_with(*paths, steps);
            if (!end) break;
            for (int c = 0; c < 3; ++c) {
                const double left = std::pow(glass.attenuation_color[c],
                                             crossings * 2 * cos_within / glass.attenuation_distance);
                CHECK(end->weight[c] ==
                      Approx((1 - inner) * std::pow(inner, crossings - 1) * left).epsilon(1e-9));
            }
        }
    }
}

TEST_CASE("a prism parts the colours as Snell has it for each colour's own index", "[paths][oracle]") {
    Material glass = glass_of(1.6);
    glass.dispersion = 20.0 / 30;  // Abbe number 30
    CHECK((glass.ior - 1) / (ior_of(glass, 2) - ior_of(glass, 0)) == Approx(30).epsilon(1e-12));
    CHECK(ior_of(glass, 1) == glass.ior);

    const double apex = 0.8, half = std::tan(apex / 2), incidence = 0.7;
    Stage stage;
    stage.world.fresnel = false;
    const Id prism = stage.add_body(make_prism({Vec2(-half, -1), Vec2(half, -1), Vec2(0, 0)}, 2), glass);
    const Vec3 normal(-std::cos(apex / 2), std::sin(apex / 2), 0),
        up(std::sin(apex / 2), std::cos(apex / 2), 0);
    const Vec3 direction = -std::cos(incidence) * normal + std::sin(incidence) * up;
    const auto paths = stage.follow(-0.4 * up - direction, direction);
    double last = 0;
    for (const Colours colour : {Colours{0}, Colours{1}, Colours{2}}) {
        const PathSegment* end = end_with(*paths, through({prism, prism}), colour);
        REQUIRE(end != nullptr);
        const double n = ior_of(glass, colour);
        const double within = std::asin(std::sin(incidence) / n);
        const double deviation = incidence + std::asin(n * std::sin(apex - within)) - apex;
        CHECK(std::acos(dot(end->ray.direction, direction)) == Approx(deviation).margin(1e-9));
        CHECK(deviation > last);  // blue is turned most
        last = deviation;
        Vec3 alone(0);
        alone[colour] = 1;
        CHECK(end->weight == alone);
        CHECK(end->principal == (colour == 1));
    }
}

TEST_CASE("the same paths again from the same place, and from beside it", "[paths]") {
    Random random(47);
    int compared = 0;
    for (int i = 0; i < 60; ++i) {
        Stage stage;
        fill(stage, random, 1.0);
        const Vec3 from = 5.0 * random.direction(), direction = normalize(random.in_box(0.5) - from);
        const auto first = next_optic(stage.world, {{from, direction}});
        if (!first) continue;
        const FollowedPaths paths = follow_paths(stage.world, {first->meeting, first->distance});
        const auto again = repeat_paths(stage.world, {first->meeting, first->distance}, paths.segments);
        REQUIRE(again.size() == paths.segments.size());
        for (std::size_t s = 0; s < again.size(); ++s) {
            const PathSegment& one = paths.segments[s];
            REQUIRE(again[s].has_value());
            CHECK(again[s]->ray.origin == one.ray.origin);
            CHECK(again[s]->ray.direction == one.ray.direction);
            CHECK(again[s]->way == one.way);
            CHECK(again[s]->next == one.next);
            CHECK(again[s]->turned == one.turned);
        }
        // From beside: as followed there, wherever that has the history.
        const Vec3 beside = normalize(direction + 1e-4 * random.direction());
        const auto near = next_optic(stage.world, {{from, beside}});
        if (!near || near->meeting.optic != first->meeting.optic) continue;
        const FollowedPaths there = follow_paths(stage.world, {near->meeting, near->distance},
                                                 {.objects = nullptr, .least_weight = 0.1 * kLeastWeight});
        const auto like = repeat_paths(stage.world, {near->meeting, near->distance}, paths.segments);
        for (std::size_t s = 0; s < like.size(); ++s) {
            if (!like[s] || !like[s]->ends) continue;
            const PathSegment* end =
                end_with(there, steps_to(paths.segments, static_cast<Id>(s)), paths.segments[s].colours);
            if (!end) continue;
            ++compared;
            CHECK(end->ray.origin == like[s]->ray.origin);
            CHECK(end->ray.direction == like[s]->ray.direction);
        }
    }
    CHECK(compared > 50);
}
