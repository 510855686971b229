// Pieces one pixel wide: measured along the axis they have, else unmeasured; never another image of the
// point.
#include "measure/displacement/image_query.h"

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

constexpr int kSliverWidth = 80, kSliverHeight = 40;

/// A wide piece in columns 20..39, and beside nothing else, along a curve of pixels 20 columns and more away,
/// the same points again, as a rim shows them: a pixel there holds 40 times as much across.
Field rim(const std::function<bool(int column, int row)>& is_rim, const Vec2& by) {
    return [=](double x, double y) {
        const double u = x + by.x, v = y + by.y;
        const int column = static_cast<int>(x), row = static_cast<int>(y);
        if (column >= 20 && column < 40) return Seen{4, 0, Vec3(0.05 * u, 0.05 * v, 0.001 * v * v)};
        if (!is_rim(column, row)) return Seen{};
        return Seen{4, 0, Vec3(1.5 + 2 * by.x, 0.05 * v, 0.001 * v * v)};
    };
}

bool is_column(int column, int) {
    return column == 52;
}

bool is_diagonal(int column, int row) {
    return column == 42 + row && row < 30;
}

/// A row of pixels that sees `curve`, one step of one unit per pixel.
Image line_of(int count, const std::function<Vec3(double at)>& curve) {
    return image_of(count, 3, [&](double x, double y) {
        return y > 1 && y < 2 ? Seen{1, 0, curve(x)} : Seen{};
    });
}

}  // namespace

TEST_CASE("the shift of a sliver is measured along it and falls with the error", "[measure][sliver]") {
    const Image reference = image_of(kSliverWidth, kSliverHeight, rim(is_column, Vec2(0)));
    double before = 0;
    for (const double size : {0.4, 0.1, 0.025, 0.00625}) {
        const Vec2 by(0.005 * size, size);
        const Displacement found =
            measure_displacement(reference, image_of(kSliverWidth, kSliverHeight, rim(is_column, by)), "reflect")
                .value();
        INFO("shift " << size);
        for (std::size_t row = 1; row + 1 < kSliverHeight; ++row) {
            const std::size_t i = row * kSliverWidth + 52;
            REQUIRE(found.state[i] == Shift::kFound);
            CHECK(static_cast<double>(found.shift_y[i]) == Approx(size).epsilon(0.01));
            CHECK(found.shift_x[i] == 0);
        }
        CHECK(found.lost == 0);
        CHECK(found.summary.value().max < 1.1 * size);
        if (before > 0) CHECK(before / found.summary->mean == Approx(4).epsilon(0.01));
        before = found.summary->mean;
    }
}

TEST_CASE("a sliver's shift across is not taken for one along: it is unmeasured", "[measure][sliver]") {
    // Across by 0.1, a step along is at most 0.1: the line through the pixels passes the point by more than
    // half a step.
    const Image reference = image_of(kSliverWidth, kSliverHeight, rim(is_column, Vec2(0)));
    const Displacement across =
        measure_displacement(reference, image_of(kSliverWidth, kSliverHeight, rim(is_column, Vec2(0.05, 0.001))),
                             "reflect")
            .value();
    for (std::size_t row = 0; row < kSliverHeight; ++row)
        CHECK(across.state[row * kSliverWidth + 52] == Shift::kUnmeasured);
    CHECK(across.unmeasured == kSliverHeight);
    CHECK(across.lost == 0);
    CHECK(across.summary.value().max < 0.051);
}

TEST_CASE("single pixels in a diagonal have no axis: unmeasured, not twenty pixels away",
          "[measure][sliver]") {
    const Image reference = image_of(kSliverWidth, kSliverHeight, rim(is_diagonal, Vec2(0)));
    const Displacement found =
        measure_displacement(reference, image_of(kSliverWidth, kSliverHeight, rim(is_diagonal, Vec2(0, 0.01))),
                             "reflect")
            .value();
    CHECK(found.unmeasured == 30);
    CHECK(found.lost == 0);
    CHECK(found.summary.value().max < 0.011);
}

TEST_CASE("a wide piece is followed as far as it moved, however far another image lies",
          "[measure][sliver]") {
    // The slopes allow what they say: a true shift of eight pixels is no other image.
    const Field wide = [](double x, double y) {
        return Seen{4, 0, Vec3(0.05 * x, 0.07 * y, 0.0003 * x * y)};
    };
    const Image reference = image_of(60, 60, wide);
    for (const double by : {0.3, 2.0, 8.0}) {
        const Image test = image_of(60, 60, [&](double x, double y) { return wide(x + by, y - 0.5 * by); });
        const Displacement found = measure_displacement(reference, test, "reflect").value();
        CHECK(found.summary.value().p50 == Approx(std::hypot(by, 0.5 * by)).epsilon(1e-3));
        CHECK(static_cast<double>(found.pixels) > (60 - by - 1) * (60 - 0.5 * by - 1));
    }
}

TEST_CASE("find_along_sliver inverts a curve it was not told", "[measure][sliver]") {
    std::mt19937 random(5);
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int round = 0; round < 300; ++round) {
        // A helix of random pitch and turn; a step of one unit is at most a quarter of its radius.
        const double radius = number(4, 40), pitch = number(0.1, 2), phase = number(0, 6),
                     scale = number(0.01, 10);
        const auto curve = [&](double at) {
            const double angle = phase + at / radius;
            return scale * Vec3(radius * std::cos(angle), radius * std::sin(angle), pitch * at);
        };
        const Image image = line_of(40, curve);
        PositionField field = make_seen_field(image, "reflect").value();
        link_neighbours(field);
        const int column = static_cast<int>(number(6, 34));
        const double shift = (round % 2 ? 1 : -1) * std::exp(number(std::log(1e-3), std::log(5.0)));
        const FieldSample wanted{curve(column + 0.5 + shift), 1, 0, 0, column, 1};
        INFO("round " << round << " shift " << shift << " radius " << radius);
        const std::optional<Vec2> found = find_along_sliver(field, wanted);
        REQUIRE(found.has_value());
        CHECK(found->y == 0);
        // A parabola through three points misses a circle by its third difference.
        CHECK(found->x == Approx(shift).epsilon(1 / (radius * radius)).margin(2e-5));

        // Off the line by more than it may be, whatever the way: along the axis of the helix tilted outward.
        const double angle = phase + (column + 0.5) / radius;
        const Vec3 outward(std::cos(angle), std::sin(angle), 0);
        FieldSample off = wanted;
        off.point = curve(column + 0.5) + scale * 1.2 * std::hypot(1.0, pitch) * outward;
        CHECK_FALSE(find_along_sliver(field, off).has_value());
    }
    // Alone, and at the end of a line: a pixel beyond it at most.
    const auto straight = [](double at) { return Vec3(at, 2 * at, -at); };
    const Image image = line_of(5, straight), single = line_of(1, straight);
    PositionField field = make_seen_field(image, "reflect").value(),
                  alone = make_seen_field(single, "reflect").value();
    link_neighbours(field);
    link_neighbours(alone);
    CHECK(find_along_sliver(field, {straight(5.2), 1, 0, 0, 1, 1}).value().x == Approx(3.7));
    CHECK_FALSE(find_along_sliver(field, {straight(5.7), 1, 0, 0, 1, 1}).has_value());
    CHECK_FALSE(find_along_sliver(alone, {straight(0.6), 1, 0, 0, 0, 1}).has_value());
}

TEST_CASE("slopes say how many pixels a step takes", "[measure][slope]") {
    std::mt19937 random(6);
    const auto number = [&] { return std::normal_distribution<double>()(random); };
    for (int round = 0; round < 300; ++round) {
        const double scale = std::pow(10, number());
        const Vec3 right = scale * Vec3(number(), number(), number()),
                   down = scale * Vec3(number(), number(), number());
        const Vec2 pixels(number(), number());
        const Vec3 normal = normalize(cross(right, down));
        const double off = std::abs(number()) * scale;
        // A test of a plane: the step is put together from its parts.
        const Vec3 step = pixels.x * right + pixels.y * down + off * normal;
        const double expected = glm::length(pixels) + off / std::max(length(right), length(down));
        CHECK(pixels_for({right, down}, step).value() == Approx(expected).epsilon(1e-6));
        CHECK(pixels_for({right, std::nullopt}, pixels.x * right + off * normal).value() ==
              Approx(std::abs(pixels.x)).epsilon(1e-9));
        CHECK(pixels_for({std::nullopt, down}, pixels.y * down).value() == Approx(std::abs(pixels.y)));
    }
    const Vec3 x(1, 0, 0);
    CHECK_FALSE(pixels_for({}, x).has_value());
    CHECK(std::isinf(pixels_for({Vec3(0), std::nullopt}, x).value()));
    CHECK(std::isinf(pixels_for({x, 2.0 * x}, x).value()));
    CHECK(pixels_for({x, 2.0 * x}, Vec3(0)).value() == 0);
    CHECK(pixels_for({Vec3(0), std::nullopt}, Vec3(0)).value() == 0);

    const Image image = image_of(5, 4, [](double u, double v) {
        return u < 4 ? Seen{1, 0, Vec3(u * u, 3 * v, 0)} : Seen{};
    });
    PositionField field = make_seen_field(image, "reflect").value();
    link_neighbours(field);
    CHECK(slopes_at(field, 1, 1).right.value() == Vec3(3, 0, 0));  // ((2.5)^2 - (0.5)^2) / 2
    CHECK(slopes_at(field, 3, 0).right.value() == Vec3(6, 0, 0));  // (3.5)^2 - (2.5)^2
    CHECK(slopes_at(field, 3, 0).down.value() == Vec3(0, 3, 0));
    CHECK_FALSE(slopes_at(field, 4, 2).right.has_value());
}
