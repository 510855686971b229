// Folds are found where a field turns over and nowhere else; off them a mean displacement falls with the
// error's order.
#include "measure/field/position_field.h"

#include <algorithm>
#include <cmath>

#include "measure/displacement/displacement.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::Field;
using trilens_test::image_of;
using trilens_test::mirror_sphere;
using trilens_test::Seen;

namespace {

constexpr int kSize = 120;

std::vector<std::uint8_t> folds_of(const Field& field) {
    const Image image = image_of(kSize, kSize, field);
    PositionField seen = make_seen_field(image, "reflect").value();
    link_neighbours(seen);
    return near_folds(seen);
}

std::ptrdiff_t count(const std::vector<std::uint8_t>& near) {
    return std::count(near.begin(), near.end(), 1);
}

/// A plane seen twice, its images meeting in the column `at`; `error` moves what is seen.
Field folded(double at, double error) {
    return [=](double x, double y) {
        const double u = (x - at) / kSize;
        return Seen{2, 0, Vec3(u * u + error, y / kSize, 0.3 * y / kSize)};
    };
}

}  // namespace

TEST_CASE("a fold is found wherever it runs, with pixels at most kFoldReach + 2 from it",
          "[measure][folds]") {
    const double at = GENERATE(20.0, 33.5, 60.3, 99.9);
    const std::vector<std::uint8_t> near = folds_of(folded(at, 0));
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            const double away = std::abs(x + 0.5 - at);
            CAPTURE(x, y, at);
            const bool is_near = near[static_cast<std::size_t>(y * kSize + x)] == 1;
            if (away < kFoldReach - 1) CHECK(is_near);
            if (away > kFoldReach + 3) CHECK(!is_near);
        }
    }
}

TEST_CASE("a plane, a convex mirror, two walls that meet and one that hides the other have no fold",
          "[measure][folds]") {
    CHECK(count(folds_of([](double x, double y) { return Seen{1, 0, Vec3(x, 0.3 * x + y, 0.1 * y)}; })) == 0);
    CHECK(count(folds_of([](double x, double y) { return Seen{1, 0, Vec3(-x, y, 4)}; })) == 0);
    CHECK(count(folds_of([](double x, double y) { return mirror_sphere(x, y, kSize); })) == 0);
    // Two walls that meet in a column, and one that hides the other.
    CHECK(count(folds_of([](double x, double y) {
              return Seen{1, 0, Vec3(std::min(x, 57.2), y, std::max(0.0, x - 57.2))};
          })) == 0);
    CHECK(count(folds_of([](double x, double y) {
              return Seen{1, 0, x < 50 ? Vec3(x, y, 0) : Vec3(x, y, 40)};
          })) == 0);
    CHECK(count(folds_of([](double, double) { return Seen{}; })) == 0);
}

TEST_CASE("off a fold the mean displacement falls like the error, over all pixels more slowly",
          "[measure][folds]") {
    const Image reference = image_of(kSize, kSize, folded(60.3, 0));
    double before = 0, before_off = 0, order = 0, order_off = 0;
    for (const double error : {4e-4, 1e-4, 2.5e-5}) {
        const Displacement found =
            measure_displacement(reference, image_of(kSize, kSize, folded(60.3, error)), "reflect").value();
        CHECK(found.near_folds > static_cast<std::size_t>(kSize));
        CHECK(found.near_folds < static_cast<std::size_t>(14 * kSize));
        CHECK(found.mean_off_folds.value() < found.summary.value().mean);
        // Where u' ^ 2 = u ^ 2 + error: the displacement is near error / (2 u), u = distance / kSize.
        if (before > 0) {
            order = std::log(before / found.summary.value().mean) / std::log(4.0);
            order_off = std::log(before_off / found.mean_off_folds.value()) / std::log(4.0);
        }
        before = found.summary.value().mean;
        before_off = found.mean_off_folds.value();
    }
    CHECK(order < 0.93);
    CHECK(order_off == Approx(1).margin(0.03));
}
