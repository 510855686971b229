// Bodies of glass inside of one another: which of them a ray feels, against concentric spheres.
#include "intersect/random_scene.h"
#include "paths/bodies.h"
#include "paths/stage.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// The glass between two spheres about the origin, one body: the inner side's front is the hollow.
class Shell : public Surface {
  public:
    Shell(double outer, double inner)
        : outer_(FaceDomain::kSquare, Vec3(0), outer), inner_(FaceDomain::kSquare, Vec3(0), inner) {}
    std::size_t face_count() const override { return 12; }
    FaceDomain domain(Id) const override { return FaceDomain::kSquare; }
    SurfacePoint eval(Id face, const Vec2& uv) const override {
        if (face < 6) return outer_.eval(face, uv);
        SurfacePoint p = inner_.eval(face - 6, {uv.y, uv.x});
        std::swap(p.du, p.dv), std::swap(p.duu, p.dvv);
        set_normal(p);
        return p;
    }

  private:
    ProjectedSphere outer_, inner_;
};

/// A ray at the distance h from the centre passes a sphere of radius r from index n to m: it is turned
/// towards the centre by this. n r sin(angle) = h on its whole way (Bouguer).
double media_turn_at(double h, double r, double n, double m) {
    return std::asin(h / (n * r)) - std::asin(h / (m * r));
}

/// How far the path without reflections is turned; `events` counts its steps.
double turned(const Stage& stage, double h, std::size_t* events = nullptr) {
    const auto paths = stage.follow({h, 0, 3}, {0, 0, -1});
    REQUIRE(paths.has_value());
    for (std::size_t s = 0; s < paths->segments.size(); ++s) {
        const PathSegment& one = paths->segments[s];
        if (!one.ends || one.path != Path::kRefract) continue;
        const std::vector<Step> steps = steps_to(paths->segments, static_cast<Id>(s));
        if (std::any_of(steps.begin(), steps.end(),
                        [](const Step& step) { return step.event == Event::kReflect; }))
            continue;
        if (events) *events = steps.size();
        CHECK(one.medium == kNone);
        return std::atan2(-one.ray.direction.x, -one.ray.direction.z);
    }
    FAIL("no path straight through");
    return 0;
}

constexpr double kMediaGlass = 1.5, kMediaWater = 1.33, kMediaInner = 0.6, kLiquid = 0.75;

}  // namespace

TEST_CASE("liquid that reaches into its glass: the one of higher priority is inside", "[paths]") {
    for (const double h : {0.0, 0.1, 0.3, 0.5, 0.65}) {
        for (const bool glass_first : {true, false}) {
            const auto stage_of = [&](Stage& stage, int glass, int liquid) {
                const auto add_glass = [&] {
                    stage.add_body(Shell(1, kMediaInner), glass_of(kMediaGlass), glass);
                };
                if (glass_first) add_glass();
                stage.add_ball(Vec3(0), kLiquid, glass_of(kMediaWater), liquid);
                if (!glass_first) add_glass();
            };
            const double outside = 2 * media_turn_at(h, 1, 1, kMediaGlass);
            const auto inside = [&](double r) {
                return h < kMediaWater * r ? media_turn_at(h, r, kMediaGlass, kMediaWater) : 0;
            };
            INFO("h " << h << ", glass " << (glass_first ? "first" : "second"));

            Stage glass_wins;
            stage_of(glass_wins, 1, 0);
            if (h < kMediaWater * kMediaInner)
                CHECK(turned(glass_wins, h) == Approx(outside + 2 * inside(kMediaInner)).margin(1e-9));

            Stage liquid_wins;
            stage_of(liquid_wins, 0, 1);
            CHECK(turned(liquid_wins, h) == Approx(outside + 2 * inside(kLiquid)).margin(1e-9));

            // Of equal ones the one that the ray came into last: the liquid's own skin on the way in, the
            // glass's on the way out.
            if (h >= kMediaWater * kMediaInner) continue;
            Stage equal;
            stage_of(equal, 3, 3);
            CHECK(turned(equal, h) == Approx(outside + inside(kLiquid) + inside(kMediaInner)).margin(1e-9));
        }
    }
}

TEST_CASE("liquid that just fills its glass, or ends before it", "[paths]") {
    // A gap of air: turned at every skin.
    Stage gap;
    gap.add_body(Shell(1, 0.8), glass_of(kMediaGlass), 1);
    gap.add_ball(Vec3(0), 0.5, glass_of(kMediaWater));
    const double h = 0.3;
    std::size_t steps = 0;
    CHECK(turned(gap, h, &steps) ==
          Approx(2 * (media_turn_at(h, 1, 1, kMediaGlass) + media_turn_at(h, 0.8, kMediaGlass, 1) +
                      media_turn_at(h, 0.5, 1, kMediaWater)))
              .margin(1e-9));
    CHECK(steps == 6);
}

TEST_CASE("two bodies of one glass that overlap are one body", "[paths]") {
    Stage two;
    two.world.fresnel = false;
    const Material glass = glass_of(1.5);
    const Id a = two.add_body(make_box({-3, -3, -1}, {3, 3, 0}), glass);
    const Id b = two.add_body(make_box({-3, -3, -2}, {3, 3, -0.5}), glass);
    // One material, one object in memory.
    two.world.optics[b].material = two.world.optics[a].material;
    const auto paths = two.follow({0, 0, 2}, {0.5, 0, -1});
    const std::vector<Step> steps{
        {a, Event::kTransmit}, {b, Event::kPass}, {a, Event::kPass}, {b, Event::kTransmit}};
    const PathSegment* end = end_with(*paths, steps);
    REQUIRE(end != nullptr);
    CHECK(end->depth == 1);  // passing counts for nothing
    Stage one;
    one.world.fresnel = false;
    const Id body = one.add_body(make_box({-3, -3, -2}, {3, 3, 0}), glass);
    const auto whole = one.follow({0, 0, 2}, {0.5, 0, -1});
    const PathSegment* same = end_with(*whole, through({body, body}));
    REQUIRE(same != nullptr);
    CHECK(length(same->ray.origin - end->ray.origin) < 1e-9);
    CHECK(length(same->ray.direction - end->ray.direction) < 1e-9);
    CHECK(same->way == Approx(end->way).epsilon(1e-9));
}

TEST_CASE("the camera in the glass: what leaves is turned away from the normal, what is reflected stays",
          "[paths][law]") {
    Stage stage;
    const Id ball = stage.add_ball(Vec3(0), 1, glass_of(1.5));
    for (const double h : {0.0, 0.2, 0.5, 0.66, 0.7}) {
        const auto paths = stage.follow({h, 0, 0}, {0, 0, -1});
        REQUIRE(paths.has_value());
        const PathSegment* end = end_with(*paths, through({ball}));
        CHECK((end != nullptr) == (1.5 * h < 1));
        if (!end) continue;
        const double out = std::asin(1.5 * h) - std::asin(h);
        CHECK(std::atan2(-end->ray.direction.x, -end->ray.direction.z) == Approx(out).margin(1e-9));
        CHECK(end->medium == kNone);
        for (const PathSegment& one : paths->segments)
            if (one.parent == kNone && one.step.event == Event::kReflect) CHECK(one.medium == ball);
    }
}

TEST_CASE("more bodies around a ray than can be told are light lost, and said so", "[paths]") {
    Stage stage;
    stage.world.max_depth = 30;
    for (int i = 0; i < Media::kMost + 1; ++i)
        stage.add_ball(Vec3(0), 2 - 0.1 * i, glass_of(1.1 + 0.05 * i), i);
    const auto paths = stage.follow({0.05, 0, 5}, {0, 0, -1});
    CHECK(of_worst_colour(paths->cut.lost) > 0.5);
    Stage fewer;
    fewer.world.max_depth = 30;
    for (int i = 0; i < Media::kMost; ++i) fewer.add_ball(Vec3(0), 2 - 0.1 * i, glass_of(1.1 + 0.05 * i), i);
    const auto all = fewer.follow({0.05, 0, 5}, {0, 0, -1});
    CHECK(all->cut.lost == Vec3(0));
    CHECK(turned(fewer, 0.05) != 0);
}
