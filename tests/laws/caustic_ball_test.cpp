// A glass ball's light on a floor, by Snell's law and Fresnel's equations in the plane of lamp, ball and
// place.
#include <algorithm>
#include <array>
#include <cmath>

#include "support/lit_world.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Where light falls on the floor, in the plane x = 0, and what is left of it.
struct Fall {
    double z = NAN, weight = 0;  // NaN: it does not fall
};

Fall fall_on_floor(const Vec2& from, const Vec2& to, double weight) {
    if (!(to.y < 0)) return {};
    return {from.x - from.y / to.y * to.x, weight};
}

/// A lamp at (0, 4, 3), a ball of glass around (0, 1, 0): what it mirrors and what goes through, by Snell's
/// law and Fresnel's equations. `angle`: at the lamp, from the way to the ball's middle.
std::array<Fall, 2> falls_of(double angle) {
    constexpr double kRadius = 0.8, kIndex = 1.5;
    const Vec2 lamp(3, 4), middle(0, 1);  // z, y
    const Vec2 axis = glm::normalize(middle - lamp), side(-axis.y, axis.x);
    const auto toward = [&](double turned) { return std::cos(turned) * axis + std::sin(turned) * side; };
    const double sine = length(middle - lamp) * std::sin(angle) / kRadius;
    if (std::fabs(sine) >= 1) return {};
    const double in = std::asin(sine), inside = std::asin(sine / kIndex);
    const double s = (std::cos(in) - kIndex * std::cos(inside)) / (std::cos(in) + kIndex * std::cos(inside));
    const double p = (std::cos(inside) - kIndex * std::cos(in)) / (std::cos(inside) + kIndex * std::cos(in));
    const double mirrored = 0.5 * (s * s + p * p);
    const Vec2 normal = -toward(angle - in), ray = toward(angle);
    // Seen from the middle it leaves where the chord ends; twice it was turned by in - inside.
    return {fall_on_floor(middle + kRadius * normal, ray - 2 * glm::dot(ray, normal) * normal, mirrored),
            fall_on_floor(middle + kRadius * toward(angle + 2 * inside - in),
                          toward(angle + 2 * (inside - in)), (1 - mirrored) * (1 - mirrored))};
}

/// Irradiance on the floor at (0, 0, z): each angle's light falls on a ring around the axis, which goes
/// through (0, 4, 3) and (0, 1, 0).
double light_over_ball(double z) {
    constexpr int kAngles = 400'000;
    constexpr double kMost = 0.19;  // beyond the ball
    const double off_axis = std::fabs(z + 1) / std::sqrt(2.0);
    double sum = 0;
    std::array<Fall, 2> before;
    for (int i = 0; i <= kAngles; ++i) {
        const double angle = kMost * (2.0 * i / kAngles - 1);
        const std::array<Fall, 2> now = falls_of(angle);
        for (std::size_t k = 0; k < 2; ++k)
            if ((now[k].z - z) * (before[k].z - z) <= 0)
                sum += 10 * now[k].weight * std::fabs(std::sin(angle)) /
                       (off_axis * std::fabs(now[k].z - before[k].z) / (2 * kMost / kAngles));
        before = now;
    }
    return sum;
}

}  // namespace

TEST_CASE("light that a ball of glass sends along a floor is as Snell and Fresnel have it",
          "[laws][law][caustics][thorough]") {
    // Part of the same beams rises and never falls on the floor.
    const LitWorld lit(lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 kLamp));
    double faintest = 1, brightest = 0;
    for (double z = -5.4; z < -2.1; z += 0.2) {
        Receiver there = on_floor(0, z);
        there.sides = {Vec3(0.02, 0, 0), Vec3(0, 0, 0.02)};
        there.exact = true;
        const double expected = light_over_ball(z), found = lit.light().irradiance(there).y;
        CAPTURE(z, expected, found);
        CHECK(found == Approx(expected).epsilon(0.005));
        faintest = std::min(faintest, expected), brightest = std::max(brightest, expected);
    }
    CHECK(brightest > 10 * faintest);
}

TEST_CASE("where all of a beam's light comes it is the same as by a look at each way",
          "[laws][law][caustics]") {
    const LitWorld lit(lit_world(R"({"name": "ball", "role": "optic", "material": "glass", "resolution": 8,
        "primitive": {"type": "sphere", "center": [0, 1, 0], "radius": 0.8}})",
                                 kLamp));
    int lit_places = 0;
    for (double z = -5.4; z < 1; z += 0.2)
        for (const double x : {0.0, 0.3, -1.1}) {
            Receiver plain = on_floor(x, z);
            plain.sides = {Vec3(0.02, 0, 0), Vec3(0, 0, 0.02)};
            // A normal that is not quite the plane's asks for each direction.
            Receiver turned = plain;
            turned.shading_normal = normalize_or_zero(Vec3(1e-10, 1, 0));
            const Vec3 light = lit.light().irradiance(plain), by_ways = lit.light().irradiance(turned);
            CAPTURE(x, z, light.y);
            for (int c = 0; c < 3; ++c) CHECK(light[c] == Approx(by_ways[c]).epsilon(1e-8).margin(1e-12));
            lit_places += light.y > 0;
        }
    CHECK(lit_places > 30);
}
