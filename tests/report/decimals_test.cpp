// Numbers as decimals.
#include "report/decimals.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <string>

#include "base/error.h"
#include "support/test.h"

using namespace trilens;

namespace {

std::string by_library(double value, std::chars_format format, int digits) {
    char room[400];
    return {room, std::to_chars(room, room + sizeof room, value, format, digits).ptr};
}

/// Values of every kind that rounds in its own way.
double random_value(std::mt19937_64& random) {
    const double sign = random() % 2 ? -1 : 1;
    const auto bits = random();
    double value;
    switch (random() % 6) {
        case 0:
            std::memcpy(&value, &bits, sizeof value);
            return value;
        case 1:
            return sign * std::ldexp(static_cast<double>(bits % 100000), -static_cast<int>(random() % 14));
        case 2:
            return sign * std::pow(10.0, static_cast<double>(random() % 14) - 5) *
                   (1 + static_cast<double>(static_cast<int>(bits % 9) - 4) * 0x1p-52);
        case 3:
            return sign * (std::pow(10.0, static_cast<double>(random() % 8)) -
                           std::pow(10.0, -static_cast<double>(random() % 14)) / 2);
        case 4:
            return sign * static_cast<double>(bits % 4096);
        default:
            return sign * std::exp(std::uniform_real_distribution<double>(-12, 18)(random));
    }
}

}  // namespace

TEST_CASE("decimals are those of the library, whatever the number", "[report]") {
    std::mt19937_64 random(9);
    std::size_t wrong = 0;
    for (int trial = 0; trial < 400000; ++trial) {
        const double value = random_value(random);
        const int digits = static_cast<int>(random() % 13);
        std::string fixed = "a", significant = "b";
        append_fixed(fixed, value, digits);
        append_significant(significant, value, std::max(1, digits));
        wrong += fixed != "a" + by_library(value, std::chars_format::fixed, digits);
        wrong += significant != "b" + by_library(value, std::chars_format::general, std::max(1, digits));
    }
    CHECK(wrong == 0);
}

TEST_CASE("decimals have up to twelve digits", "[report]") {
    std::string text;
    append_fixed(text, 640.125, 2);
    append_significant(text += ' ', 0.1, 12);
    CHECK(text == "640.12 0.1");
    for (const int digits : {-1, 13}) {
        CHECK_THROWS_AS(append_fixed(text, 1, digits), UsageError);
        CHECK_THROWS_AS(append_significant(text, 1, digits), UsageError);
    }
    CHECK_THROWS_AS(append_significant(text, 1, 0), UsageError);
}
