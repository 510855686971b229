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

Seen loss_plane(double x, double y) {
    return {1, 0, Vec3(0.05 * x, 0.05 * y, 0)};
}

/// The plane where the column is at most `last`.
Image plane_until(double last, double by = 0) {
    return image_of(80, 50, [=](double x, double y) { return x < last ? loss_plane(x + by, y) : Seen{}; });
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
        CHECK(there.pixels + there.lost + there.unmeasured == test_shows);
        CHECK(there.coverage.value() * static_cast<double>(either) ==
              Approx(static_cast<double>(there.pixels)));
        CHECK(there.coverage.value() <= 1);
    }
}

TEST_CASE("no pixel that shows the same triangle in both pictures is lost", "[measure][loss][law]") {
    std::mt19937 random(31);
    const auto number = [&](double size) {
        return std::uniform_real_distribution<double>(-size, size)(random);
    };
    std::size_t lost = 0, unmeasured = 0, found = 0;
    for (int round = 0; round < 40; ++round) {
        // Confetti: pieces of any size from one pixel on, moved by any amount, of any roughness.
        const int size = 1 << random() % 5;
        const double rough = std::pow(10, -3 + number(3)), by = std::pow(10, -1 + number(2));
        const std::size_t seed = random();
        const auto picture = [&](double moved, double change) {
            return image_of(37, 29, [&](double x, double y) {
                std::mt19937 cell(static_cast<unsigned>(seed + static_cast<std::size_t>(x / size) * 91 +
                                                        static_cast<std::size_t>(y / size) * 7));
                const Id object = cell() % 4 ? static_cast<Id>(cell() % 3) : kNone;
                if (object == kNone) return Seen{};
                const bool is_other = std::abs(number(1)) < change;
                return Seen{object, static_cast<Id>(is_other ? 9 : cell() % 2),
                            Vec3(0.1 * (x + moved), 0.1 * y, rough * number(1))};
            });
        };
        const Image reference = picture(0, 0), test = picture(by, 0.1);
        const Displacement here = measure_displacement(reference, test, "reflect").value();
        for (std::size_t i = 0; i < here.state.size(); ++i) {
            const auto same = [&](const char* name) {
                return reference.find(name)->ids()[i] == test.find(name)->ids()[i];
            };
            const bool is_same = test.find("reflect.object")->ids()[i] != kNone && same("reflect.object") &&
                                 same("reflect.primitive");
            if (here.state[i] == Shift::kLost) CHECK_FALSE(is_same);
            if (here.state[i] == Shift::kUnmeasured) {
                CHECK(is_same);
                CHECK((here.shift_x[i] == 0 && here.shift_y[i] == 0));
            }
        }
        lost += here.lost;
        unmeasured += here.unmeasured;
        found += here.pixels;
    }
    INFO(found << " found, " << lost << " lost, " << unmeasured << " unmeasured");
    CHECK(lost > 500);
    CHECK(unmeasured > 500);
    CHECK(found > 5000);
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
        // All that the reference shows at all, and its continued edge; the rest it never shows. The plane is
        // seen in either picture everywhere, so none of it is lost.
        CHECK_FALSE(found.summary.has_value());
        CHECK(found.unmeasured == 4000);
        CHECK(found.lost + found.missing == 0);
        CHECK(static_cast<double>(found.beyond_radius) >= (80 - by) * 50);
        CHECK(static_cast<double>(found.beyond_radius) <= (81 - by) * 50);
    }
}
