// The sun in a ball of water: both rainbows on a screen, by Snell's law and Fresnel's equations in the plane
// of a ray and the ball's middle.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "inverse/maps/caustic_map.h"
#include "render/world/world.h"
#include "scene/load.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

/// Of scenes/caustics/rainbow.json: the ball's distance from the screen, the screen's half side, the sun.
constexpr double kDropRadius = 0.6, kScreenFar = 2.2, kScreenHalf = 2.6, kSunLight = 90;
constexpr double kWaterIndex[3] = {1.308, 1.333,
                                   1.358};  // 1.333, and 3 / 20 of that less 1 between red and blue
constexpr double kFollowedShare = 1.0 / 200;
constexpr std::size_t kBowRings = 1600;
constexpr double kBowRingWidth = 4.0 / kBowRings;

double drop_reflectance(double cosine, double inside, double index) {
    const double s = (cosine - index * inside) / (cosine + index * inside),
                 p = (inside - index * cosine) / (inside + index * cosine);
    return 0.5 * (s * s + p * p);
}

/// Light by one ray on the screen: where, and what is left of it.
struct OnScreen {
    double radius = NAN, weight = 0;
};

/// Of a ray that comes so far beside the middle, as a share of the radius, and is reflected so often inside;
/// -1: outside alone.
OnScreen on_screen(double beside, double index, int reflections) {
    const double in = std::asin(beside), inner = std::asin(beside / index);
    const double mirrored = drop_reflectance(std::cos(in), std::cos(inner), index);
    const double pi = std::acos(-1.0);
    // Angles from the way of the sun: of the place where it leaves the ball, and of its direction.
    double place = pi - in, direction = pi - 2 * in, weight = mirrored;
    if (reflections >= 0) {
        const double turn = pi - 2 * inner;
        place -= (reflections + 1) * turn;
        direction = -(2 * (in - inner) + reflections * turn);
        weight = (1 - mirrored) * (1 - mirrored) * std::pow(mirrored, reflections);
    }
    if (!(std::cos(direction) < -1e-9) || weight < kFollowedShare) return {};
    const double t = -(kScreenFar + kDropRadius * std::cos(place)) / std::cos(direction);
    return {std::fabs(kDropRadius * std::sin(place) + t * std::sin(direction)), weight};
}

/// Irradiance in rings on the screen around the sun's way through the ball's middle.
std::vector<double> light_in_rings(double index) {
    constexpr int kRays = 2'000'000;  // of equal areas of the ball
    std::vector<double> rings(kBowRings);
    const double flux = kSunLight * std::acos(-1.0) * kDropRadius * kDropRadius / kRays;
    for (int i = 0; i < kRays; ++i)
        for (const int reflections : {-1, 1, 2}) {
            const OnScreen there = on_screen(std::sqrt((i + 0.5) / kRays), index, reflections);
            if (there.radius < kBowRings * kBowRingWidth)
                rings[static_cast<std::size_t>(there.radius / kBowRingWidth)] += flux * there.weight;
        }
    for (std::size_t i = 0; i < kBowRings; ++i)
        rings[i] /= std::acos(-1.0) * kBowRingWidth * kBowRingWidth * (2 * static_cast<double>(i) + 1);
    return rings;
}

/// The mean over a pixel of a square map of the screen.
double mean_over_pixel(const std::vector<double>& rings, int x, int y, int side) {
    constexpr int kParts = 16;
    double sum = 0;
    for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i) {
            const double u = 2 * kScreenHalf * (x + (i + 0.5) / kParts) / side - kScreenHalf,
                         v = 2 * kScreenHalf * (y + (j + 0.5) / kParts) / side - kScreenHalf;
            sum += rings[static_cast<std::size_t>(std::hypot(u, v) / kBowRingWidth)];
        }
    return sum / (kParts * kParts);
}

}  // namespace

TEST_CASE("the sun in a ball of water draws both rainbows, and nothing between them that is not there",
          "[laws][law][caustics][thorough]") {
    constexpr int kSide = 160;
    const auto world = make_world(load_scene(source_dir() + "/scenes/caustics/rainbow.json", {}, {}), ignore);
    CausticMapRequest request;
    request.target = parse_target("screen:160x160", world->scene);
    const CausticMap map = make_caustic_map(*world, request);
    for (int c = 0; c < 3; ++c) {
        const std::vector<double> rings = light_in_rings(kWaterIndex[c]);
        std::vector<double> off;
        double square = 0, mean = 0;
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const auto i = static_cast<std::size_t>(y * kSide + x);
                if (!map.covered[i]) continue;
                const double expected = mean_over_pixel(rings, x, y, kSide);
                const double difference = map.irradiance[i][c] - expected;
                off.push_back(std::fabs(difference) / expected);
                square += difference * difference, mean += expected;
            }
        const auto count = static_cast<double>(off.size());
        mean /= count;
        std::sort(off.begin(), off.end());
        const double median = off[off.size() / 2], rms = std::sqrt(square / count) / mean;
        CAPTURE(c, mean, median, rms);
        CHECK(mean > 0.1);
        CHECK(median < 0.01);
        CHECK(rms < 0.05);
    }
}
