// Irradiance of each kind of light against closed forms and against rays in all directions.
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "support/shaded_triangle.h"
#include "support/test.h"

using namespace trilens;

namespace {

constexpr double kPi = std::numbers::pi;

/// A white matt floor y = 0 about the origin, seen from above.
struct Floor : trilens_test::ShadedTriangle {
    Hit hit{0, 1.0, {1.0 / 3, 1.0 / 3}};
    Ray ray{{0, 1, 0}, {0, -1, 0}};

    explicit Floor(const Light& light)
        : trilens_test::ShadedTriangle({{{-1, 0, 1}, {2, 0, 1}, {-1, 0, -2}}}, light) {
        shading.size = 10;
    }
    /// At the origin.
    double irradiance() {
        prepare_lights(shading);
        std::array<Vec3, 1> light;
        const std::array<SeenAlong, 1> seen{SeenAlong{&hit, &ray}};
        shade_rays(shading, seen, light);
        CHECK(light[0] == shade_hit(shading, hit, ray));
        return kPi * light[0].x;
    }
};

Light of_kind(const LightKind& kind, bool shadows = false) {
    Light light;
    light.kind = kind;
    light.shadows = shadows;
    light.intensity = 3;
    return light;
}

double irradiance_of(const LightKind& kind) {
    return Floor(of_kind(kind)).irradiance();
}

/// Whether something stands in a segment's way, by a test of its own.
void set_occluder(Floor& floor, const std::function<bool(const Ray&)>& hides) {
    floor.shading.occluded = [hides](const Segments& segments) {
        Segments::Bits hidden = 0;
        for (std::size_t i = 0; i < segments.count; ++i)
            if (hides(segments.ray(i))) hidden |= Segments::bit(i);
        return hidden;
    };
}

/// Irradiance at the origin on the floor by rays at random, cosine distributed, that each find a radiance.
double by_rays(const std::function<double(const Vec3&)>& radiance, int count = 400000) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        const double r2 = uniform(random), phi = 2 * kPi * uniform(random), r = std::sqrt(r2);
        sum += radiance({r * std::cos(phi), std::sqrt(1 - r2), r * std::sin(phi)});
    }
    return kPi * sum / count;
}

}  // namespace

TEST_CASE("lights of an area have the irradiance that rays find", "[shade][oracle]") {
    const Vec3 middle(0.7, 1.3, -0.4), shines = normalize(Vec3(-0.3, -1, 0.6));
    const auto meets = [&](const Vec3& toward, const std::function<bool(const Vec3&)>& inside) {
        const double along = dot(toward, shines);
        if (along >= 0) return 0.0;
        return inside(dot(middle, shines) / along * toward - middle) ? 3.0 : 0.0;
    };

    const RectangleLight rectangle{middle, shines, {1.2, 0.6}, {1, 0, 0}, 256};
    const Vec3 upward = normalize(Vec3(1, 0, 0) - shines.x * shines), across = cross(upward, shines);
    CHECK(irradiance_of(rectangle) == Approx(by_rays([&](const Vec3& toward) {
                                          return meets(toward, [&](const Vec3& off) {
                                              return std::fabs(dot(off, across)) < 0.6 &&
                                                     std::fabs(dot(off, upward)) < 0.3;
                                          });
                                      })).epsilon(0.01));

    const DiskLight disk{middle, shines, 0.6, 256};
    CHECK(irradiance_of(disk) == Approx(by_rays([&](const Vec3& toward) {
                                     return meets(toward, [&](const Vec3& off) { return length(off) < 0.6; });
                                 })).epsilon(0.01));

    const SphereLight sphere{middle, 0.6, 256};
    CHECK(irradiance_of(sphere) == Approx(by_rays([&](const Vec3& toward) {
                                       return length(cross(toward, middle)) < 0.6 && dot(toward, middle) > 0
                                                  ? 3.0
                                                  : 0.0;
                                   })).epsilon(0.01));
}

TEST_CASE("lights of an area have the irradiance of closed forms", "[shade][oracle]") {
    // Disk over the point: pi L r^2 / (r^2 + d^2). Sphere wholly above the horizon: pi L (r / d)^2 cos.
    CHECK(irradiance_of(DiskLight{{0, 2, 0}, {0, -1, 0}, 0.5, 1024}) ==
          Approx(kPi * 3 * 0.25 / 4.25).epsilon(1e-3));
    const Vec3 at(1, 2, 0.5);
    CHECK(irradiance_of(SphereLight{at, 0.7, 1024}) ==
          Approx(kPi * 3 * 0.49 / dot(at, at) * normalize(at).y).epsilon(1e-3));
    // A square parallel to the floor, its middle over the point: Howell's catalogue, B-3, four times.
    const double a = 0.5, r = std::sqrt(1 + a * a);
    const double quarter = (a / r * std::atan(a / r) * 2) / (2 * kPi);
    CHECK(irradiance_of(RectangleLight{{0, 1, 0}, {0, -1, 0}, {1, 1}, {0, 0, 1}, 1024}) ==
          Approx(3 * kPi * 4 * quarter).epsilon(1e-3));
    // From behind there is none, and inside a sphere neither.
    CHECK(irradiance_of(DiskLight{{0, 2, 0}, {0, 1, 0}, 0.5}) == 0);
    CHECK(irradiance_of(SphereLight{{0, 0.1, 0}, 0.5}) == 0);

    // A sun's irradiance is that on a surface that faces it, whatever its angle.
    for (const double angle : {0.0, 0.5, 20.0, 60.0}) {
        const Vec3 down = normalize(Vec3(0.5, -1, 0));
        CHECK(irradiance_of(DirectionalLight{down, angle, 256}) == Approx(3 * -down.y).epsilon(2e-3));
    }
}

TEST_CASE("a spot light is full within its inner cone and dark beyond its outer one", "[shade]") {
    const double straight = irradiance_of(PointLight{{0, 2, 0}});
    CHECK(straight == Approx(3.0 / 4));
    const auto at = [&](double degrees, double inner, double outer) {
        const double turn = degrees * kPi / 180;
        return irradiance_of(SpotLight{{0, 2, 0}, {std::sin(turn), -std::cos(turn), 0}, inner, outer});
    };
    CHECK(at(0, 10, 30) == Approx(straight));
    CHECK(at(9.9, 10, 30) == Approx(straight));
    CHECK(at(30.1, 10, 30) == 0);
    // KHR_lights_punctual: the square of the cosine's share.
    const double c = std::cos(20 * kPi / 180), i = std::cos(10 * kPi / 180), o = std::cos(30 * kPi / 180);
    CHECK(at(20, 10, 30) == Approx(straight * std::pow((c - o) / (i - o), 2)));
}

TEST_CASE("white surfaces in white light are white: each light's furnace", "[shade][law]") {
    // Radiance 3 from everywhere leaves a white matt surface as radiance 3.
    CHECK(irradiance_of(AmbientLight{}) == Approx(3 * kPi).epsilon(1e-15));
    Floor occlusion(of_kind(AmbientLight{.samples = 64}, true));
    set_occluder(occlusion, [](const Ray&) { return false; });
    CHECK(occlusion.irradiance() == Approx(3 * kPi).epsilon(1e-12));
    CHECK(irradiance_of(DirectionalLight{{0, -1, 0}, 179, 4096}) == Approx(3).epsilon(1e-3));

    for (const int samples : {64, 512}) {
        Floor floor(of_kind(EnvironmentLight{samples}));
        floor.shading.background.color = Vec3(1);
        CHECK(floor.irradiance() == Approx(3 * kPi).epsilon(1e-4));
    }
}

TEST_CASE("an environment's directions carry all of its picture's light", "[shade][oracle]") {
    // A sky of two colours and a small sun; the floor sees what rays find.
    Background background;
    auto sky = std::make_shared<Texture>();
    sky->width = 128, sky->height = 64;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 128; ++x) {
            const bool sun = x > 80 && x < 84 && y > 12 && y < 16;
            for (int c = 0; c < 3; ++c)
                sky->rgb.push_back(sun ? 500.0f : (c == 2 ? 0.5f : 0.1f) * (1 + std::cos(0.1f * float(x))));
        }
    background.environment = sky;
    background.rotate_cos = std::cos(1), background.rotate_sin = std::sin(1);
    const double truth =
        by_rays([&](const Vec3& toward) { return 3 * shade_background(background, toward).x; }, 2000000);
    for (const int samples : {16, 64, 1024}) {
        Floor floor(of_kind(EnvironmentLight{samples}));
        floor.shading.background = background;
        CHECK(floor.irradiance() == Approx(truth).epsilon(0.02));
        CHECK(sample_count(floor.shading, 0) <= static_cast<std::size_t>(samples));
    }
}

TEST_CASE("soft shadows hide the share of a light that is hidden, the better the more samples",
          "[shade][law]") {
    // A half-plane x > e at height 1 under a square light of side 1 at height 2: over the origin it hides the
    // part of the light beyond x = 2 e.
    for (const int samples : {16, 64, 1024}) {
        double worst = 0;
        for (double e = -0.24; e < 0.25; e += 0.01) {
            Floor floor(
                of_kind(RectangleLight{{0, 200, 0}, {0, -1, 0}, {100, 100}, {0, 0, 1}, samples}, true));
            const double whole = floor.irradiance();
            set_occluder(floor, [e](const Ray& way) {
                const double t = (100 - way.origin.y) / way.direction.y;
                return t > 0 && t < 1 && way.origin.x + t * way.direction.x > 100 * e;
            });
            // Of Lambert's law the light's middle has a little more: its own closed form is in the next case.
            const double share = floor.irradiance() / whole, seen = 0.5 + 2 * e;
            worst = std::max(worst, std::fabs(share - seen));
        }
        INFO(samples << " samples: " << worst);
        CHECK(worst < 0.55 / samples + 0.02);
    }
    // Half of the sky hidden, seen from a wall's foot: half of the irradiance.
    Floor floor(of_kind(AmbientLight{.samples = 1024}, true));
    set_occluder(floor, [](const Ray& way) { return way.direction.x > 0; });
    CHECK(floor.irradiance() == Approx(1.5 * kPi).epsilon(1e-2));
    // What stands farther than the light's distance hides nothing.
    Floor near(of_kind(AmbientLight{.distance = 2, .samples = 16}, true));
    set_occluder(near, [](const Ray& way) { return way.direction.y > 2.001; });
    CHECK(near.irradiance() == Approx(3 * kPi).epsilon(1e-9));
}
