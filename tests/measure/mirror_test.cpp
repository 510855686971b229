// Laws of comparing: a picture differs in nothing from itself, and two pictures differ as much whichever is
// the reference.
#include <cmath>
#include <random>

#include "measure/compare.h"
#include "measure/synthetic.h"
#include "support/test.h"

using namespace trilens;
using trilens_test::image_of;
using trilens_test::Seen;

namespace {

constexpr int kMirrorWidth = 33, kMirrorHeight = 27;

/// A picture of coloured noise at any brightness, with pieces of objects that are seen at smooth places; `by`
/// moves them.
Image random_picture(std::mt19937& random, double by) {
    const auto number = [&](double size) {
        return std::uniform_real_distribution<double>(-size, size)(random);
    };
    const double bend = number(0.02), amount = std::pow(10, number(2));
    Image image = image_of(kMirrorWidth, kMirrorHeight, [&](double x, double y) {
        if (random() % 9 == 0) return Seen{};
        const double u = x + by;
        return Seen{static_cast<Id>(u > 12), static_cast<Id>(y > 9), Vec3(0.1 * u, 0.1 * y, bend * u * y)};
    });
    for (const char* name : {"R", "G", "B", "A"}) {
        std::vector<float> values(image.pixels());
        for (float& value : values) value = static_cast<float>(std::abs(number(amount)));
        image.channels.push_back({name, values});
    }
    return image;
}

double value_of(const std::vector<NamedMetric>& metrics, const std::string& name) {
    for (const NamedMetric& metric : metrics)
        if (metric.name == name) return metric.value.value_or(NAN);
    FAIL("there is no metric " << name);
    return 0;
}

std::vector<NamedMetric> metrics_of(const Image& reference, const Image& test) {
    return named_metrics(compare(reference, test), compare_layers(reference, test));
}

}  // namespace

TEST_CASE("a picture differs in nothing from itself", "[measure][compare][law]") {
    std::mt19937 random(41);
    for (int round = 0; round < 20; ++round) {
        const Image image = random_picture(random, 0);
        const Comparison same = compare(image, image);
        CHECK(same.verdict == Verdict::kPass);
        CHECK(same.worst.channel.empty());
        for (const NamedMetric& metric : metrics_of(image, image)) {
            INFO(metric.name);
            if (!metric.value) continue;  // of layers that are not there, and away from folds
            if (metric.name == "psnr_db")
                CHECK(std::isinf(*metric.value));
            else if (metric.is_likeness)
                CHECK(*metric.value == 1);
            else
                CHECK(*metric.value == 0);
        }
    }
}

TEST_CASE("two pictures differ as much whichever is the reference", "[measure][compare][law]") {
    std::mt19937 random(42);
    for (int round = 0; round < 20; ++round) {
        const double by = std::pow(10.0, std::uniform_real_distribution<double>(-3, 0.8)(random));
        const Image one = random_picture(random, 0), other = random_picture(random, by);
        const auto there = metrics_of(one, other), back = metrics_of(other, one);
        const auto same = [&](const std::string& name, const std::string& mirrored) {
            INFO(name << ", " << by);
            CHECK(value_of(there, name) == Approx(value_of(back, mirrored)).epsilon(1e-12));
        };
        for (const char* name :
             {"mae", "rmse", "psnr_db", "ssim", "rgb_flip", "max", "p50", "p95", "p99", "object_mismatch",
              "primitive_mismatch", "coverage_mismatch", "fail", "hard", "warn"})
            same(name, name);
        same("lost", "missing");
        same("missing", "lost");
    }
}

TEST_CASE("what moved one way has moved back the other way", "[measure][displacement][law]") {
    // Smooth fields that are seen everywhere: the mean displacement is the same from either side, to the
    // second order in it.
    std::mt19937 random(43);
    for (int round = 0; round < 20; ++round) {
        const double size = std::pow(10.0, std::uniform_real_distribution<double>(-3, 0)(random)),
                     angle = std::uniform_real_distribution<double>(0, 6)(random);
        const auto picture = [&](double by) {
            return image_of(80, 60, [&](double x, double y) {
                const double u = x + by * std::cos(angle), v = y + by * std::sin(angle);
                return Seen{2, 0, Vec3(0.1 * u + 0.0004 * u * v, 0.1 * v, 0.0005 * u * u)};
            });
        };
        const Image one = picture(0), other = picture(size);
        const Displacement there = measure_displacement(one, other, "reflect").value(),
                           back = measure_displacement(other, one, "reflect").value();
        CHECK(there.summary.value().mean == Approx(size).epsilon(2e-3).margin(1e-4));
        CHECK(back.summary.value().mean == Approx(there.summary->mean).epsilon(2e-3).margin(1e-4));
        const std::size_t middle = 30 * 80 + 40;
        REQUIRE((there.state[middle] == Shift::kFound && back.state[middle] == Shift::kFound));
        CHECK(static_cast<double>(there.shift_x[middle] + back.shift_x[middle]) ==
              Approx(0).margin(2e-4 + 1e-3 * size));
        CHECK(static_cast<double>(there.shift_y[middle] + back.shift_y[middle]) ==
              Approx(0).margin(2e-4 + 1e-3 * size));
    }
}
