// Where the mirror shows the environment, directions are displaced as points are.
#include <algorithm>
#include <cmath>
#include <functional>

#include "measure/displacement/displacement.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::environment;
using trilens_test::Field;
using trilens_test::image_of;
using trilens_test::Seen;

namespace {

constexpr int kEnvironmentWidth = 96, kEnvironmentHeight = 72;

/// What a curved mirror may show of the sky: directions of a film in front of an eye, bent a little.
Seen sky(double x, double y) {
    const double u = (x - 48) / 60, v = (y - 36) / 60;
    return environment(Vec3(u + 0.1 * u * v, -v + 0.08 * u * u, -1));
}

Image with_optic(Image image, Id optic) {
    image.channels.push_back({"optic.object", std::vector<Id>(image.pixels(), optic)});
    return image;
}

using EnvironmentWarp = std::function<Vec2(double x, double y)>;

Displacement measure_sky(const Field& field, const EnvironmentWarp& warp) {
    const Image reference = with_optic(image_of(kEnvironmentWidth, kEnvironmentHeight, field), 5);
    const Image test = with_optic(image_of(kEnvironmentWidth, kEnvironmentHeight,
                                           [&](double x, double y) {
                                               const Vec2 from = warp(x, y);
                                               return field(from.x, from.y);
                                           }),
                                  5);
    return measure_displacement(reference, test, "reflect").value();
}

/// The largest error of the found shifts that lead to places inside the film, and of the others, where the
/// reference is continued beyond its edge.
struct Errors {
    double inside = 0, beyond = 0;
};

Errors errors_of(const Displacement& found, const EnvironmentWarp& warp) {
    Errors errors;
    for (std::size_t i = 0; i < found.state.size(); ++i) {
        if (found.state[i] != Shift::kFound) continue;
        const double x = static_cast<double>(i % kEnvironmentWidth) + 0.5,
                     y = static_cast<double>(i / kEnvironmentWidth) + 0.5;
        const Vec2 to = warp(x, y);
        const bool is_inside =
            to.x > 0.5 && to.y > 0.5 && to.x < kEnvironmentWidth - 0.5 && to.y < kEnvironmentHeight - 0.5;
        double& largest = is_inside ? errors.inside : errors.beyond;
        largest = std::max(largest, glm::length(to - Vec2(x, y) - Vec2(found.shift_x[i], found.shift_y[i])));
    }
    return errors;
}

}  // namespace

TEST_CASE("a field of directions that is moved, turned or scaled gives its shift", "[measure][environment]") {
    for (const double size : {0.002, 0.05, 0.7, 4.0}) {
        const EnvironmentWarp moved = [=](double x, double y) { return Vec2(x + size, y - 0.4 * size); };
        const EnvironmentWarp turned = [=](double x, double y) {
            const double angle = size / 40;
            return Vec2(48 + (x - 48) * std::cos(angle) - (y - 36) * std::sin(angle),
                        36 + (x - 48) * std::sin(angle) + (y - 36) * std::cos(angle));
        };
        const EnvironmentWarp scaled = [=](double x, double y) {
            return Vec2(48 + (x - 48) * (1 - size / 100), 36 + (y - 36) * (1 - size / 100));
        };
        int which = 0;
        for (const EnvironmentWarp& warp : {moved, turned, scaled}) {
            INFO("shift " << size << " warp " << which++);
            const Displacement found = measure_sky(sky, warp);
            // Directions of length 1, 1 / 60 per pixel: their rounding is 1e-5 pixels.
            const Errors errors = errors_of(found, warp);
            CHECK(errors.inside < 3e-4);
            CHECK(errors.beyond < 0.03);
            const double beyond = (size + 1) * (kEnvironmentWidth + kEnvironmentHeight);
            CHECK(static_cast<double>(found.pixels) >=
                  kEnvironmentWidth * kEnvironmentHeight - (size < 0.8 ? 0 : beyond));
            CHECK(found.lost == 0);
            CHECK(found.pixels + found.unmeasured == kEnvironmentWidth * kEnvironmentHeight);
        }
    }
}

TEST_CASE("a turn of the whole sky moves its picture as a pinhole says", "[measure][environment]") {
    // A pinhole's directions, turned about the upright axis by an angle: in the middle row the picture moves
    // from f tan(a) to f tan(a + angle).
    const double f = 60;
    for (const double angle : {1e-4, 1e-2, 0.1}) {
        const auto pinhole = [&](double x, double y, double turn) {
            const Vec3 way((x - 48) / f, -(y - 36.5) / f, -1);
            return environment(Vec3(way.x * std::cos(turn) - way.z * std::sin(turn), way.y,
                                    way.x * std::sin(turn) + way.z * std::cos(turn)));
        };
        const Image reference = with_optic(
            image_of(kEnvironmentWidth, kEnvironmentHeight, [&](double x, double y) { return pinhole(x, y, 0); }), 1);
        const Image test = with_optic(
            image_of(kEnvironmentWidth, kEnvironmentHeight, [&](double x, double y) { return pinhole(x, y, angle); }),
            1);
        const Displacement found = measure_displacement(reference, test, "reflect").value();
        for (int column = 10; column < 80; ++column) {
            const std::size_t i = 36 * kEnvironmentWidth + static_cast<std::size_t>(column);
            const double x = column + 0.5 - 48, expected = f * std::tan(std::atan(x / f) + angle) - x;
            REQUIRE(found.state[i] == Shift::kFound);
            CHECK(static_cast<double>(found.shift_x[i]) == Approx(expected).margin(3e-4));
            CHECK(static_cast<double>(found.shift_y[i]) == Approx(0).margin(3e-4));
        }
    }
}

TEST_CASE("the environment and an object never answer for one another", "[measure][environment][law]") {
    // A ball of radius 1 round the origin shows points that are, as numbers, directions.
    const Field ball = [](double x, double y) { return Seen{3, 0, sky(x, y).point}; };
    const Image directions = with_optic(image_of(kEnvironmentWidth, kEnvironmentHeight, sky), 5),
                points = with_optic(image_of(kEnvironmentWidth, kEnvironmentHeight, ball), 5);
    const Displacement found = measure_displacement(directions, points, "reflect").value();
    CHECK(found.pixels == 0);
    CHECK(found.lost == kEnvironmentWidth * kEnvironmentHeight);
    CHECK(found.missing == kEnvironmentWidth * kEnvironmentHeight);

    // Side by side, with a border that moves by less than a pixel.
    const Field both = [&](double x, double y) { return x + 0.3 * y < 50 ? ball(x, y) : sky(x, y); };
    for (const double by : {0.01, 0.6}) {
        const EnvironmentWarp warp = [=](double x, double y) { return Vec2(x + by, y); };
        const Displacement moved = measure_sky(both, warp);
        // At the border either side is continued by as much as it moved.
        CHECK(errors_of(moved, warp).inside < 0.02 * by + 1e-3);
        CHECK(moved.lost == 0);
        CHECK(moved.coverage.value() == 1);
    }
}

TEST_CASE("the environment counts through an optic and with a direction only", "[measure][environment]") {
    const Image test = image_of(kEnvironmentWidth, kEnvironmentHeight, sky);
    // No optic at all.
    const Displacement unlit =
        measure_displacement(with_optic(test, kNone), with_optic(test, kNone), "reflect").value();
    CHECK_FALSE(unlit.coverage.has_value());
    // Zeros: an image that gives no direction.
    const Image blank =
        with_optic(image_of(kEnvironmentWidth, kEnvironmentHeight, [](double, double) { return Seen{}; }), 5);
    CHECK_FALSE(measure_displacement(blank, blank, "reflect")->coverage.has_value());
    // Through another optic it is another thing.
    CHECK(measure_displacement(with_optic(test, 4), with_optic(test, 5), "reflect")->lost ==
          kEnvironmentWidth * kEnvironmentHeight);
    // A direction that is no number is lost, not skipped.
    Image broken = with_optic(test, 5);
    broken.find("reflect.Z")->floats()[77] = std::nanf("");
    const Displacement found = measure_displacement(with_optic(test, 5), broken, "reflect").value();
    CHECK(found.lost == 1);
    CHECK(found.pixels == kEnvironmentWidth * kEnvironmentHeight - 1);
}
