// FLIP in closed form where pictures are even, and its properties elsewhere; the Python tests hold a second
// implementation against it.
#include "measure/pixel/flip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <vector>

#include "base/util/parallel.h"
#include "support/test.h"

using namespace trilens;

namespace {

struct Film {
    int width, height;
    std::vector<float> r, g, b;

    Film(int w, int h, float red, float green, float blue)
        : width(w),
          height(h),
          r(static_cast<std::size_t>(w * h), red),
          g(r.size(), green),
          b(r.size(), blue) {}
    ColourPicture picture() const { return {width, height, r, g, b}; }
};

Film noise(unsigned seed) {
    Film film(37, 29, 0, 0, 0);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> value(0, 1);
    for (auto* channel : {&film.r, &film.g, &film.b})
        for (float& v : *channel) v = value(random);
    return film;
}

double lightness(double y) {
    return 116 * std::cbrt(y) - 16;
}

}  // namespace

TEST_CASE("even greys differ by their lightness alone, spread over 0 to 1", "[measure][flip]") {
    constexpr double kLargest = 41.27609841459544;  // of green against blue, to the power 0.7
    for (const auto& [a, b] : {std::pair{0.2f, 0.25f}, {0.5f, 0.1f}, {0.9f, 0.91f}}) {
        const double distance =
            std::pow(std::abs(lightness(static_cast<double>(a)) - lightness(static_cast<double>(b))), 0.7);
        const double knee = 0.4 * kLargest;
        const double expected =
            distance < knee ? 0.95 * distance / knee : 0.95 + 0.05 * (distance - knee) / (kLargest - knee);
        const Film one(24, 16, a, a, a), other(24, 16, b, b, b);
        for (const float error : flip_map(one.picture(), other.picture()))
            CHECK(static_cast<double>(error) == Approx(expected).epsilon(1e-6));
    }
}

TEST_CASE("equal pictures have no error, others one from 0 to 1 that is the same both ways",
          "[measure][flip]") {
    const Film a = noise(1), b = noise(2);
    for (const float error : flip_map(a.picture(), a.picture())) CHECK(error == 0);
    const std::vector<float> there = flip_map(a.picture(), b.picture()),
                             back = flip_map(b.picture(), a.picture());
    CHECK(there == back);
    for (const float error : there) {
        CHECK(error > 0);
        CHECK(error <= 1);
    }
}

TEST_CASE("what a screen cannot show is no difference", "[measure][flip]") {
    const Film white(20, 20, 1, 1, 1), sun(20, 20, 500, 20, 3), black(20, 20, 0, 0, 0),
        under(20, 20, -1, 0, 0);
    for (const float error : flip_map(white.picture(), sun.picture())) CHECK(error == 0);
    for (const float error : flip_map(black.picture(), under.picture())) CHECK(error == 0);
}

TEST_CASE("a pixel that is not finite has no error of its own and spoils no other", "[measure][flip]") {
    const Film a = noise(3);
    Film b = a;
    b.g[200] = std::numeric_limits<float>::quiet_NaN();
    const std::vector<float> errors = flip_map(a.picture(), b.picture());
    for (std::size_t i = 0; i < errors.size(); ++i) {
        if (i == 200)
            CHECK(std::isnan(errors[i]));
        else
            CHECK(errors[i] == 0);
    }
}

TEST_CASE("farther away small differences are seen less", "[measure][flip]") {
    const Film a(64, 64, 0.5f, 0.5f, 0.5f);
    Film b = a;
    for (std::size_t i = 0; i < b.r.size(); ++i) b.r[i] = b.g[i] = b.b[i] = i % 2 ? 0.6f : 0.4f;  // stripes
    const auto mean = [&](double per_degree) {
        double sum = 0;
        for (const float error : flip_map(a.picture(), b.picture(), per_degree))
            sum += static_cast<double>(error);
        return sum;
    };
    CHECK(mean(20) > 1.5 * mean(67));
}

TEST_CASE("FLIP has the same bits for any number of threads", "[measure][flip][law]") {
    const Film a = noise(4), b = noise(5);
    set_thread_count(1);
    const std::vector<float> one = flip_map(a.picture(), b.picture());
    set_thread_count(0);
    CHECK(flip_map(a.picture(), b.picture()) == one);
}

TEST_CASE("where pictures agree nothing is measured, and elsewhere nothing changes by that",
          "[measure][flip][oracle]") {
    std::mt19937 random(6);
    const auto below = [&](int limit) { return std::uniform_int_distribution<int>(0, limit - 1)(random); };
    const auto random_film = [&](int width, int height) {
        Film film(width, height, 0, 0, 0);
        for (auto* channel : {&film.r, &film.g, &film.b})
            for (float& v : *channel) v = std::uniform_real_distribution<float>(-0.1f, 1.2f)(random);
        return film;
    };
    constexpr double kPerDegree = 20;
    constexpr int kReach = 3;  // of the filters there, pixels
    for (int trial = 0; trial < 60; ++trial) {
        const Film a = random_film(18 + below(40), 18 + below(30));
        Film patched = a;
        const int x0 = below(a.width), y0 = below(a.height), x1 = x0 + 1 + below(6), y1 = y0 + 1 + below(6);
        for (int y = y0; y < std::min(y1, a.height); ++y)
            for (int x = x0; x < std::min(x1, a.width); ++x) {
                const std::size_t i = static_cast<std::size_t>(y * a.width + x);
                patched.g[i] = trial % 5 ? 1 - patched.g[i] : std::numeric_limits<float>::infinity();
            }
        // Two opposite corners that differ as well: then everything is measured.
        Film everywhere = patched;
        everywhere.r.front() += 0.5f;
        everywhere.r.back() += 0.5f;
        const std::vector<float> part = flip_map(a.picture(), patched.picture(), kPerDegree),
                                 whole = flip_map(a.picture(), everywhere.picture(), kPerDegree);
        std::size_t compared = 0;
        for (int y = 0; y < a.height; ++y)
            for (int x = 0; x < a.width; ++x) {
                const bool first = x <= kReach && y <= kReach;
                const bool last = x >= a.width - 1 - kReach && y >= a.height - 1 - kReach;
                if (first || last) continue;
                const std::size_t i = static_cast<std::size_t>(y * a.width + x);
                const bool is_same = part[i] == whole[i] || (std::isnan(part[i]) && std::isnan(whole[i]));
                if (!is_same) FAIL_CHECK("(" << x << ", " << y << "): " << part[i] << ", " << whole[i]);
                ++compared;
            }
        CHECK(compared > 200);
    }
}

TEST_CASE("what was made of a reference before serves the next test as well", "[measure][flip][golden]") {
    std::mt19937 random(7);
    const Film a = noise(8);
    FlipReference kept;
    for (int trial = 0; trial < 40; ++trial) {
        Film b = a;
        const std::size_t changes = 1 + random() % 5;
        for (std::size_t k = 0; k < changes; ++k) {
            float& value = b.b[random() % b.b.size()];
            value = random() % 9 ? 1 - value : std::numeric_limits<float>::quiet_NaN();
        }
        const std::vector<float> alone = flip_map(a.picture(), b.picture()),
                                 again = flip_map(a.picture(), b.picture(), kFlipPixelsPerDegree, &kept);
        for (std::size_t i = 0; i < alone.size(); ++i)
            if (alone[i] != again[i] && !(std::isnan(alone[i]) && std::isnan(again[i])))
                FAIL_CHECK("trial " << trial << ", pixel " << i << ": " << alone[i] << ", " << again[i]);
    }
}
