// What could not be measured is said, in both directions.
#include <cmath>
#include <random>

#include "measure/displacement/displacement.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Field;
using trilens_test::image_of;
using trilens_test::Seen;

namespace {

Seen plane(double x, double y) {
    return {1, 0, Vec3(0.05 * x, 0.05 * y, 0)};
}

/// The plane where the column is at most `last`.
Image plane_until(double last, double by = 0) {
    return image_of(80, 50, [=](double x, double y) { return x < last ? plane(x + by, y) : Seen{}; });
}

}  // namespace

TEST_CASE("half an object missing from the test is no perfect picture of it", "[measure][loss]") {
    const Image whole = plane_until(80), half = plane_until(40);
    const Displacement found = measure_displacement(whole, half, "reflect").value();
    CHECK(found.summary.value().mean == 0);
    CHECK(found.pixels == 2000);
    CHECK(found.lost == 0);
    // The edge is continued by up to a pixel, so the next column may still be found.
    CHECK(found.missing >= 39 * 50);
    CHECK(found.missing <= 40 * 50);
    CHECK(found.coverage.value() == Approx(0.5));

    const Displacement swapped = measure_displacement(half, whole, "reflect").value();
    CHECK(swapped.lost == found.missing);
    CHECK(swapped.missing == 0);
    CHECK(swapped.coverage.value() == Approx(0.5).margin(50.0 / 4000));
}

TEST_CASE("losses change places with the images", "[measure][loss]") {
    std::mt19937 random(23);
    const auto number = [&](double size) {
        return std::uniform_real_distribution<double>(-size, size)(random);
    };
    for (int round = 0; round < 30; ++round) {
        const double size = std::pow(10, number(3)), x0 = 15 + number(6), y0 = 12 + number(6),
                     r = 8 + number(5);
        const auto picture = [&](double by) {
            return image_of(31, 25, [&](double x, double y) {
                if (std::hypot(x - x0 - by, y - y0) > r) return Seen{};
                return Seen{static_cast<Id>(random() % 3), static_cast<Id>(random() % 2),
                            Vec3(0.1 * x, 0.1 * y, 0.001 * size * number(1))};
            });
        };
        const Image one = picture(0), other = picture(number(4));
        const Displacement there = measure_displacement(one, other, "reflect").value(),
                           back = measure_displacement(other, one, "reflect").value();
        CHECK(there.lost == back.missing);
        CHECK(there.missing == back.lost);
        // Every pixel of either image is accounted for once.
        std::size_t either = 0, test_shows = 0;
        for (std::size_t i = 0; i < one.pixels(); ++i) {
            const bool a = one.find("reflect.object")->ids()[i] != kNone,
                       b = other.find("reflect.object")->ids()[i] != kNone;
            either += a || b;
            test_shows += b;
        }
        CHECK(there.pixels + there.lost == test_shows);
        CHECK(there.coverage.value() * static_cast<double>(either) ==
              Approx(static_cast<double>(there.pixels)));
        CHECK(there.coverage.value() <= 1);
    }
}

TEST_CASE("with nothing measured there are no statistics", "[measure][loss]") {
    const Image plane_image = plane_until(80), nothing = plane_until(0);
    const Displacement empty = measure_displacement(nothing, nothing, "reflect").value();
    CHECK_FALSE(empty.summary.has_value());
    CHECK_FALSE(empty.mean_off_folds.has_value());
    CHECK_FALSE(empty.coverage.has_value());
    CHECK(empty.lost + empty.missing == 0);

    const Displacement all_lost = measure_displacement(nothing, plane_image, "reflect").value();
    CHECK_FALSE(all_lost.summary.has_value());
    CHECK(all_lost.coverage.value() == 0);
    CHECK(all_lost.lost == 4000);
    const Displacement all_missing = measure_displacement(plane_image, nothing, "reflect").value();
    CHECK_FALSE(all_missing.summary.has_value());
    CHECK(all_missing.coverage.value() == 0);
    CHECK(all_missing.missing == 4000);
}

TEST_CASE("a shift beyond the radius says that the radius ended it", "[measure][loss]") {
    const Image reference = plane_until(80);
    for (const double by : {3.0, 20.0, 50.0}) {
        DisplacementOptions options;
        options.radius = 12;
        const Displacement found =
            measure_displacement(reference, plane_until(80, by), "reflect", options).value();
        INFO("shift " << by);
        if (by < options.radius) {
            CHECK(found.beyond_radius == 0);
            CHECK(found.summary.value().max == Approx(by).epsilon(1e-4));
            continue;
        }
        // All that the reference shows at all, and its continued edge; the rest it never shows.
        CHECK_FALSE(found.summary.has_value());
        CHECK(found.lost == 4000);
        CHECK(static_cast<double>(found.beyond_radius) >= (80 - by) * 50);
        CHECK(static_cast<double>(found.beyond_radius) <= (81 - by) * 50);
    }
}
