// FLIP in closed form where pictures are even, and its properties elsewhere; the Python tests hold a second
// implementation against it.
#include "measure/flip.h"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/parallel.h"
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

TEST_CASE("FLIP has the same bits for any number of threads", "[measure][flip]") {
    const Film a = noise(4), b = noise(5);
    set_thread_count(1);
    const std::vector<float> one = flip_map(a.picture(), b.picture());
    set_thread_count(0);
    CHECK(flip_map(a.picture(), b.picture()) == one);
}
