// Tone curves against their inverses and against values by hand.
#include "image/tone.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/util/error.h"
#include "support/test.h"

using namespace trilens;

namespace {

/// The inverse that the Khronos PBR Neutral specification gives.
Vec3 neutral_inverse(Vec3 shown) {
    const double start = 0.8 - 0.04, desaturation = 0.15, peak = std::max({shown.x, shown.y, shown.z});
    if (peak > start) {
        const double d = 1 - start, old_peak = d * d / (1 - peak) - d + start;
        const double f = 1 / (desaturation * (old_peak - peak) + 1);
        shown = (shown + (f - 1) * Vec3(peak)) / f * (old_peak / peak);
    }
    const double y = std::min({shown.x, shown.y, shown.z});  // rounding may take it below 0
    return shown + Vec3(y < 0.04 ? std::sqrt(std::max(0.0, y) / 6.25) - y : 0.04);
}

}  // namespace

TEST_CASE("no curve: exposure doubles the light per stop, and nothing else", "[image]") {
    const Vec3 colour(0.1, 0.7, 3);
    CHECK(tone_mapped(colour, {}) == colour);
    CHECK(length(tone_mapped(colour, {3, ToneCurve::kLinear, 4}) - 8.0 * colour) < 1e-14);
    CHECK(length(tone_mapped(colour, {-2, ToneCurve::kLinear, 4}) - 0.25 * colour) < 1e-15);
    for (const ToneCurve curve :
         {ToneCurve::kLinear, ToneCurve::kReinhard, ToneCurve::kAces, ToneCurve::kNeutral}) {
        CHECK(length(tone_mapped(colour, {1, curve, 4}) - tone_mapped(2.0 * colour, {0, curve, 4})) < 1e-14);
        CHECK(length(tone_mapped(Vec3(0), {0, curve, 4})) < 1e-15);
        const double odd = std::numeric_limits<double>::quiet_NaN(), infinite = 1 / 0.0;
        CHECK(tone_mapped(Vec3(odd, -1, 0), {0, curve, 4}) == tone_mapped(Vec3(0), {0, curve, 4}));
        const Vec3 bright = tone_mapped(Vec3(infinite), {0, curve, 4});
        for (int c = 0; c < 3; ++c) CHECK(bright[c] > 0.99);
    }
}

TEST_CASE("Reinhard: grey goes by L (1 + L / w^2) / (1 + L), white becomes 1, hues stay", "[image]") {
    for (const double white : {1.0, 2.5, 4.0, 20.0}) {
        CHECK(tone_mapped(Vec3(white), {0, ToneCurve::kReinhard, white}).x == Approx(1).epsilon(1e-12));
        for (const double light : {0.01, 0.3, 1.0, 7.0}) {
            // The same curve as a blend of L / (1 + L) and L / w^2 by L / (1 + L).
            const double plain = light / (1 + light), expected = plain + plain * light / (white * white);
            CHECK(tone_mapped(Vec3(light), {0, ToneCurve::kReinhard, white}).y ==
                  Approx(expected).epsilon(1e-12));
        }
    }
    const Vec3 shown = tone_mapped(Vec3(2, 1, 0.5), {0, ToneCurve::kReinhard, 4});
    CHECK(shown.x / shown.y == Approx(2));
    CHECK(shown.y / shown.z == Approx(2));
}

TEST_CASE("ACES by Narkowicz: values by hand, rising, and the quadratic's root takes it back",
          "[image][oracle]") {
    const auto shown = [](double x) { return tone_mapped(Vec3(x), {0, ToneCurve::kAces, 4}).x; };
    CHECK(shown(1) == Approx(2.54 / 3.16));
    CHECK(shown(0.18) == Approx(0.086724 / 0.324932));
    CHECK(shown(1e6) == Approx(2.51 / 2.43).epsilon(1e-5));
    double last = -1;
    for (double x = 0; x < 20; x += 0.05) {
        const double y = shown(x);
        CHECK(y > last);
        last = y;
        const double a = 2.43 * y - 2.51, b = 0.59 * y - 0.03, c = 0.14 * y;
        if (a < -0.01) CHECK((-b - std::sqrt(b * b - 4 * a * c)) / (2 * a) == Approx(x).margin(1e-9));
    }
}

TEST_CASE("PBR Neutral: the specification's inverse takes it back", "[image]") {
    // Not from 0 on: there the inverse is a square root, which makes much of rounding.
    for (double r = 0.009; r < 6; r += 0.37)
        for (double g = 0.011; g < 6; g += 0.41)
            for (double b = 0.013; b < 6; b += 0.53) {
                const Vec3 colour(r, g, b);
                const Vec3 shown = tone_mapped(colour, {0, ToneCurve::kNeutral, 4});
                for (int c = 0; c < 3; ++c) CHECK(shown[c] < 1);
                CHECK(length(neutral_inverse(shown) - colour) < 1e-9);
            }
    // Below the shoulder a colour loses Fresnel's 4 % of white and is as it was.
    CHECK(length(tone_mapped(Vec3(0.5, 0.3, 0.2), {0, ToneCurve::kNeutral, 4}) - Vec3(0.46, 0.26, 0.16)) <
          1e-12);
}

TEST_CASE("a mapping that is none is refused", "[image][bad-input]") {
    CHECK_THROWS_AS(check_tone_mapping({101, ToneCurve::kLinear, 4}), UsageError);
    CHECK_THROWS_AS(check_tone_mapping({std::nan(""), ToneCurve::kLinear, 4}), UsageError);
    CHECK_THROWS_AS(check_tone_mapping({0, ToneCurve::kReinhard, 0}), UsageError);
    CHECK_NOTHROW(check_tone_mapping({}));
}
