// Displacements of fields that are known exactly.
#include "measure/displacement/displacement.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Field;
using trilens_test::image_of;
using trilens_test::mirror_sphere;
using trilens_test::Seen;

namespace {

/// Where the reference shows what the test shows at a position.
using Warp = std::function<Vec2(double x, double y)>;

struct Case {
    Displacement measured;
    std::vector<double> errors;  // of the found, ascending
};

Case measure(int width, int height, const Field& field, const Warp& warp) {
    const Image reference = image_of(width, height, field);
    const Image test = image_of(width, height, [&](double x, double y) {
        const Vec2 from = warp(x, y);
        return field(from.x, from.y);
    });
    Case result{measure_displacement(reference, test, "reflect").value(), {}};
    for (std::size_t i = 0; i < result.measured.state.size(); ++i) {
        if (result.measured.state[i] != Shift::kFound) continue;
        const double x = static_cast<double>(i % static_cast<std::size_t>(width)) + 0.5;
        const double y = static_cast<double>(i / static_cast<std::size_t>(width)) + 0.5;
        const Vec2 found(result.measured.shift_x[i], result.measured.shift_y[i]);
        result.errors.push_back(glm::length(warp(x, y) - Vec2(x, y) - found));
    }
    std::sort(result.errors.begin(), result.errors.end());
    return result;
}

double share(const std::vector<double>& errors, double part) {
    return errors[static_cast<std::size_t>(part * static_cast<double>(errors.size() - 1))];
}

Warp shift_by(double x, double y) {
    return [=](double u, double v) { return Vec2(u + x, v + y); };
}

/// A plane seen through an affine map that shears and stretches.
Field plane(double scale) {
    return [=](double x, double y) {
        return Seen{3, 0,
                    scale * (Vec3(1, 2, 3) + 0.03 * x * Vec3(1, 0.2, -0.1) + 0.05 * y * Vec3(0.3, -1, 0.4))};
    };
}

}  // namespace

TEST_CASE("an image is displaced from itself by exactly nothing", "[measure][displacement]") {
    const Image image = image_of(90, 90, [](double x, double y) { return mirror_sphere(x, y, 90); });
    const Displacement same = measure_displacement(image, image, "reflect").value();
    CHECK(same.pixels > 5000);
    CHECK(same.lost == 0);
    CHECK(same.summary.value().mean == 0);
    CHECK(same.summary.value().max == 0);
    CHECK(std::count(same.state.begin(), same.state.end(), Shift::kNothing) > 1000);
}

TEST_CASE("an affine field gives its shift at every scale, from a thousandth of a pixel to 30",
          "[measure][displacement][law]") {
    const double scale = GENERATE(1e-4, 1.0, 1e4);
    for (const double size : {0.001, 0.1, 0.77, 5.3, 30.0}) {
        for (const double angle : {0.3, 2.0, 4.4}) {
            const Vec2 by(size * std::cos(angle), size * std::sin(angle));
            const Case result = measure(100, 80, plane(scale), shift_by(by.x, by.y));
            INFO("scale " << scale << " shift " << size << " angle " << angle);
            // Float positions of about 10 units, 0.03 units per pixel: 1e-6 / 0.03, and extrapolation triples
            // it.
            CHECK(result.errors.back() < 5e-4);
            CHECK(share(result.errors, 0.5) < 5e-5);
            // What lies beyond the film by more than a pixel is unmeasured, as the plane is shown everywhere.
            const double beyond = (std::abs(by.x) + 1) * 80 + (std::abs(by.y) + 1) * 100;
            CHECK(static_cast<double>(result.measured.unmeasured) <= beyond);
            CHECK(result.measured.lost == 0);
            CHECK(result.measured.pixels + result.measured.unmeasured == 8000);
            if (size < 0.8) CHECK(result.measured.unmeasured == 0);
        }
    }
}

TEST_CASE("a curved field gives its shift to a ten thousandth where it is small", "[measure][displacement]") {
    const Field bowl = [](double x, double y) {
        const double u = (x - 50) / 60, v = (y - 40) / 60;
        return Seen{
            3, 0,
            Vec3(u + 0.2 * u * u * v, v - 0.15 * u * u + 0.1 * v * v * v, -3 + 0.3 * u * u + 0.2 * u * v)};
    };
    for (const double size : {0.001, 0.01, 0.1, 0.5, 3.3}) {
        const Case result = measure(100, 80, bowl, [&](double x, double y) {
            return Vec2(x + size * std::cos(0.02 * x), y + size * std::sin(0.03 * y));
        });
        INFO("shift " << size);
        CHECK(share(result.errors, 0.97) < 1e-4);
        CHECK(result.errors.back() < 2e-3);  // beyond the film's edge: half the field's second difference
    }
}

TEST_CASE("a mirror sphere in a room: small errors in the picture, counted losses",
          "[measure][displacement]") {
    constexpr int kSize = 240;
    const bool walls =
        GENERATE(true, false);  // each wall a triangle of its own, or the room one bent surface
    for (const double size : {0.001, 0.03, 0.4, 7.0}) {
        const Case result = measure(
            kSize, kSize, [&](double x, double y) { return mirror_sphere(x, y, kSize, walls); },
            [&](double x, double y) {
                return Vec2(x + size * std::cos(0.7 + x / kSize), y + size * std::sin(0.7 + y / kSize));
            });
        INFO("shift " << size << " walls " << walls);
        CHECK(result.measured.pixels > 38000);
        const std::size_t unanswered = result.measured.lost + result.measured.unmeasured;
        CHECK(static_cast<double>(unanswered) < 0.01 * static_cast<double>(result.measured.pixels));
        // Near the rim one pixel may hold half the room; there the reference itself does not say where.
        CHECK(share(result.errors, 0.5) < 2e-4);
        CHECK(share(result.errors, 0.9) < 1e-4 + (walls ? 3e-3 : 1e-2) * std::min(size, 1.0));
        CHECK(result.measured.summary.value().mean == Approx(size).epsilon(0.03));
        CHECK(result.measured.summary.value().p50 == Approx(size).epsilon(0.02));
    }
}

TEST_CASE("of two images of one point the nearer one counts", "[measure][displacement]") {
    // Folded about x = 60: every point is seen twice, at x and at 120 - x.
    const Field fold = [](double x, double y) {
        return Seen{5, 0, Vec3(0.001 * (x - 60) * (x - 60), 0.05 * y, 0)};
    };
    const double by = 0.2;
    const Case result = measure(120, 50, fold, shift_by(by, 0));
    for (std::size_t i = 0; i < result.measured.state.size(); ++i) {
        const double x = static_cast<double>(i % 120) + 0.5;
        if (std::abs(x - 60) < 1.5 || x > 119 || result.measured.state[i] != Shift::kFound) continue;
        INFO("x " << x);
        CHECK(static_cast<double>(result.measured.shift_x[i]) == Approx(by).margin(2e-3));
    }
    CHECK(result.measured.lost + result.measured.unmeasured < 100);

    // Mirrored, the near image is the one across the fold.
    const Image reference = image_of(120, 50, fold);
    const Image mirrored = image_of(120, 50, [&](double x, double y) { return fold(120 - x + 0.5, y); });
    const Displacement across = measure_displacement(reference, mirrored, "reflect").value();
    for (std::size_t i = 0; i < across.state.size(); ++i) {
        const double x = static_cast<double>(i % 120) + 0.5;
        if (x < 62 || x > 118) continue;
        CHECK(across.state[i] == Shift::kFound);
        CHECK(static_cast<double>(across.shift_x[i]) == Approx(-0.5).margin(2e-3));
    }
}

TEST_CASE("objects never answer for one another", "[measure][displacement][law]") {
    // Two objects in one plane, left and right of a slanted border.
    const Field two = [](double x, double y) {
        return Seen{x + 0.3 * y < 50 ? 1u : 2u, 0, Vec3(0.05 * x, 0.05 * y, 0)};
    };
    for (const double by : {0.01, 0.6, -0.6}) {
        const Case result = measure(100, 60, two, shift_by(by, 0.3 * by));
        CHECK(result.errors.back() < 1e-3);
        CHECK(result.measured.lost == 0);  // borders move by less than a pixel
    }

    // The same point on another object, or through another optic, is another thing.
    Image reference = image_of(40, 30, [](double x, double y) {
        return Seen{1, 0, Vec3(0.05 * x, 0.05 * y, 0)};
    });
    Image test = image_of(40, 30, [](double x, double y) { return Seen{2, 0, Vec3(0.05 * x, 0.05 * y, 0)}; });
    CHECK(measure_displacement(reference, test, "reflect")->lost == 1200);
    test = reference;
    reference.channels.push_back({"optic.object", std::vector<Id>(1200, 8)});
    test.channels.push_back({"optic.object", std::vector<Id>(1200, 9)});
    CHECK(measure_displacement(reference, test, "reflect")->lost == 1200);
}

TEST_CASE("a crease between triangles costs nothing where images name triangles",
          "[measure][displacement][law]") {
    // Two walls that meet at a right angle under a slant.
    const Field corner = [](double x, double y) {
        const double u = 0.05 * (x - 40 - 0.4 * y);
        return u < 0 ? Seen{1, 0, Vec3(u, 0.05 * y, 0)} : Seen{1, 1, Vec3(0, 0.05 * y, 2 * u)};
    };
    for (const double by : {0.003, 0.4, 3.0}) {
        const Case result = measure(90, 70, corner, shift_by(by, -0.5 * by));
        INFO("shift " << by);
        CHECK(share(result.errors, 0.98) < 1e-4);
        CHECK(result.errors.back() < 0.05 * by + 1e-3);
    }
}

TEST_CASE("one piece in front of another of the same object is not mixed with it",
          "[measure][displacement]") {
    // A strip of the object stands 2 units nearer, columns 30 to 60.
    const Field step = [](double x, double y) {
        return Seen{1, 0, Vec3(0.05 * x, 0.05 * y, x > 30 && x < 60 ? 2.0 : 0.0)};
    };
    const Case result = measure(90, 40, step, shift_by(0.3, 0));
    CHECK(result.errors.back() < 1e-3);
    CHECK(result.measured.lost == 0);
}

TEST_CASE("what the reference does not show is lost, and only that", "[measure][displacement][golden]") {
    const Field all = [](double x, double y) { return Seen{1, 0, Vec3(0.05 * x, 0.05 * y, 0)}; };
    const Field hole = [&](double x, double y) {
        return std::hypot(x - 40, y - 30) < 12 ? Seen{} : all(x, y);
    };
    const Image whole = image_of(80, 60, all), holed = image_of(80, 60, hole);
    const Displacement lost = measure_displacement(holed, whole, "reflect").value();
    for (std::size_t i = 0; i < lost.state.size(); ++i) {
        const double distance =
            std::hypot(static_cast<double>(i % 80) + 0.5 - 40, static_cast<double>(i / 80) + 0.5 - 30);
        if (distance > 12) CHECK(lost.state[i] == Shift::kFound);
        if (distance < 10) CHECK(lost.state[i] == Shift::kLost);
    }
    // The other way round the test sees nothing in the hole: no question, no loss.
    const Displacement none = measure_displacement(whole, holed, "reflect").value();
    CHECK(none.lost == 0);
    CHECK(none.pixels < 4800);
    CHECK(none.summary.value().max == 0);

    // Beyond the radius.
    DisplacementOptions near;
    near.radius = 4;
    const Image moved = image_of(80, 60, [&](double x, double y) { return all(x + 6, y); });
    CHECK(measure_displacement(whole, moved, "reflect", near)->pixels == 0);
    CHECK(measure_displacement(whole, moved, "reflect")->pixels > 4300);

    // No number is nowhere.
    Image broken = whole;
    broken.find("reflect.Y")->floats()[100] = std::numeric_limits<float>::quiet_NaN();
    CHECK(measure_displacement(whole, broken, "reflect")->lost == 1);
    CHECK(measure_displacement(broken, whole, "reflect")->summary.value().max < 1e-4);
}

TEST_CASE("the mask asks only for pixels of its optic", "[measure][displacement]") {
    const Field field = plane(1);
    Image reference = image_of(40, 20, field);
    Image test = image_of(40, 20, [&](double x, double y) { return field(x + 0.25, y); });
    std::vector<Id> optic(800, 4);
    std::fill(optic.begin(), optic.begin() + 200, 6u);
    reference.channels.push_back({"optic.object", optic});
    test.channels.push_back({"optic.object", optic});
    DisplacementOptions options;
    options.mask_object = 6;
    const Displacement masked = measure_displacement(reference, test, "reflect", options).value();
    CHECK(masked.pixels == 200);
    CHECK(masked.summary.value().mean == Approx(0.25).margin(1e-4));
    options.mask_object = 7;
    CHECK_THROWS_AS(measure_displacement(reference, test, "reflect", options), InputError);
}

TEST_CASE("images without the layer have no displacement; different images are refused",
          "[measure][displacement][bad-input]") {
    const Image image = image_of(8, 8, plane(1));
    CHECK_FALSE(measure_displacement(image, image, "refract").has_value());
    CHECK_THROWS_AS(measure_displacement(image, image_of(9, 8, plane(1)), "reflect"), InputError);
}

TEST_CASE("any input gives an answer, the same for any number of threads", "[measure][displacement][law]") {
    std::mt19937 random(17);
    const auto number = [&] { return std::uniform_real_distribution<double>(-1, 1)(random); };
    const auto noise = [&](int width, int height, double spread) {
        return image_of(width, height, [&](double x, double y) {
            const Vec3 point = Vec3(0.02 * x, 0.02 * y, 0) + spread * Vec3(number(), number(), number());
            return Seen{random() % 5 == 0 ? kNone : static_cast<Id>(random() % 3),
                        static_cast<Id>(random() % 4), point};
        });
    };
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 9}, {7, 1}, {2, 2}, {33, 21}}) {
        for (const double spread : {0.0, 0.001, 1.0}) {
            const Image reference = noise(width, height, spread), test = noise(width, height, spread);
            set_thread_count(1);
            const Displacement one = measure_displacement(reference, test, "reflect").value();
            set_thread_count(5);
            const Displacement five = measure_displacement(reference, test, "reflect").value();
            set_thread_count(0);
            CHECK(one.state == five.state);
            CHECK(one.shift_x == five.shift_x);
            CHECK(one.missing == five.missing);
            const Displacement same = measure_displacement(reference, reference, "reflect").value();
            CHECK(same.summary.value_or(Summary()).max == 0);
            CHECK(same.summary.has_value() == (same.pixels > 0));
            CHECK(measure_displacement(reference, reference, "reflect")->lost == 0);
        }
    }
    // All at one place: no slope anywhere, but the place is found.
    const Image spot = image_of(10, 10, [](double, double) { return Seen{1, 0, Vec3(3, 4, 5)}; });
    CHECK(measure_displacement(spot, spot, "reflect")->summary.value().max == 0);
}
