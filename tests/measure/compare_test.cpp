// The verdict is strict, the metrics are the textbook's.
#include "measure/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "measure/pictures.h"
#include "support/test.h"

using namespace trilens;
using namespace trilens_test;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN(),
                kInfinity = std::numeric_limits<float>::infinity();

std::string refusal(const Image& reference, const Image& test) {
    try {
        compare(reference, test);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// Wang's index computed directly: every window's weights, means and centred moments, pixel by pixel.
double direct_ssim(const std::vector<double>& a, const std::vector<double>& b, int width, int height) {
    double sum = 0;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double weight = 0, ma = 0, mb = 0, aa = 0, bb = 0, ab = 0;
            for (const bool centred : {false, true}) {
                for (int j = std::max(0, y - 5); j <= std::min(height - 1, y + 5); ++j) {
                    for (int i = std::max(0, x - 5); i <= std::min(width - 1, x + 5); ++i) {
                        const double w = std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / 4.5);
                        const double p = a[static_cast<std::size_t>(j * width + i)];
                        const double q = b[static_cast<std::size_t>(j * width + i)];
                        if (centred) {
                            aa += w * (p - ma) * (p - ma) / weight;
                            bb += w * (q - mb) * (q - mb) / weight;
                            ab += w * (p - ma) * (q - mb) / weight;
                        } else {
                            weight += w;
                            ma += w * p;
                            mb += w * q;
                        }
                    }
                }
                if (!centred) ma /= weight, mb /= weight;
            }
            sum += (2 * ma * mb + 1e-4) * (2 * ab + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (aa + bb + 9e-4));
        }
    }
    return sum / (width * height);
}

}  // namespace

TEST_CASE("equal images pass with perfect numbers", "[measure][compare]") {
    const Image image = noise(1, 40, 30);
    const Comparison same = compare(image, image);
    CHECK(same.verdict == Verdict::kPass);
    CHECK(same.reasons.empty());
    CHECK(same.metrics.mae == 0);
    CHECK(same.metrics.relmse == 0);
    CHECK(same.metrics.max == 0);
    CHECK(same.metrics.ssim == 1);
    CHECK(std::isinf(same.metrics.psnr_db));
    CHECK(same.worst.channel.empty());
    CHECK(same.counts.pixels == 1200);
}

TEST_CASE("a constant offset has closed forms", "[measure][compare][oracle]") {
    const double r = 0.5, d = 0.125;
    const Comparison result = compare(constant(32, 20, 0.5f), constant(32, 20, 0.625f));
    CHECK(result.metrics.mae == Approx(d));
    CHECK(result.metrics.rmse == Approx(d));
    CHECK(result.metrics.relmse == Approx(d * d / (r * r + 0.01)));
    CHECK(result.metrics.psnr_db == Approx(20 * std::log10(1 / d)));
    CHECK(result.metrics.max == Approx(d));
    CHECK(result.metrics.p50 == Approx(d));
    CHECK(result.metrics.ssim == Approx((2 * r * (r + d) + 1e-4) / (r * r + (r + d) * (r + d) + 1e-4)));
    CHECK(result.verdict == Verdict::kFailure);
}

TEST_CASE("metrics agree with their formulas, for any number of threads", "[measure][compare][oracle][law]") {
    for (const auto& [width, height] : {std::pair{1, 1}, {7, 40}, {33, 9}, {50, 141}}) {
        const Image a = noise(2, width, height), b = noise(3, width, height);
        double sum = 0, squares = 0, relative = 0;
        std::vector<double> largest(a.pixels(), 0), grey_a(a.pixels(), 0), grey_b(a.pixels(), 0);
        const std::array<double, 3> weight = {0.2126, 0.7152, 0.0722};
        for (std::size_t c = 0; c < 3; ++c) {
            for (std::size_t i = 0; i < a.pixels(); ++i) {
                const double p = a.channels[c].floats()[i], q = b.channels[c].floats()[i];
                sum += std::abs(p - q);
                squares += (p - q) * (p - q);
                relative += (p - q) * (p - q) / (p * p + 0.01);
                largest[i] = std::max(largest[i], std::abs(p - q));
                grey_a[i] += weight[c] * p;
                grey_b[i] += weight[c] * q;
            }
        }
        const double count = 3 * static_cast<double>(a.pixels());
        std::sort(largest.begin(), largest.end());
        set_thread_count(1);
        const Comparison one = compare(a, b);
        set_thread_count(4);
        const Comparison four = compare(a, b);
        set_thread_count(0);
        CHECK(one.metrics.ssim == four.metrics.ssim);
        CHECK(one.metrics.mae == Approx(sum / count).epsilon(1e-12));
        CHECK(one.metrics.rmse == Approx(std::sqrt(squares / count)).epsilon(1e-12));
        CHECK(one.metrics.relmse == Approx(relative / count).epsilon(1e-12));
        CHECK(one.metrics.max == largest.back());
        // The nearest rank: so many values do not exceed it, and one fewer would be too few.
        for (const auto& [percent, value] :
             {std::pair{50.0, one.metrics.p50}, {95.0, one.metrics.p95}, {99.0, one.metrics.p99}}) {
            const auto not_above = static_cast<double>(
                std::upper_bound(largest.begin(), largest.end(), value) - largest.begin());
            const auto below = static_cast<double>(std::lower_bound(largest.begin(), largest.end(), value) -
                                                   largest.begin());
            CHECK(not_above >= percent / 100 * static_cast<double>(largest.size()) - 1e-9);
            CHECK(below < percent / 100 * static_cast<double>(largest.size()));
        }
        CHECK(one.metrics.ssim == Approx(direct_ssim(grey_a, grey_b, width, height)).epsilon(1e-9));
    }
}

TEST_CASE("where few pixels differ the similarity is the same mean over all", "[measure][compare]") {
    std::mt19937 random(21);
    for (int trial = 0; trial < 25; ++trial) {
        const int width = 12 + static_cast<int>(random() % 40), height = 12 + static_cast<int>(random() % 40);
        const Image a = noise(static_cast<unsigned>(trial), width, height);
        Image b = a;
        const std::size_t changes = random() % 4;
        for (std::size_t k = 0; k < changes; ++k) {
            float& value = b.find(random() % 2 ? "R" : "G")->floats()[random() % b.pixels()];
            value = 1 - value;
        }
        std::vector<double> grey_a(a.pixels(), 0.0), grey_b(grey_a);
        for (const auto& [name, weight] : {std::pair{"R", 0.2126}, {"G", 0.7152}, {"B", 0.0722}})
            for (std::size_t i = 0; i < grey_a.size(); ++i) {
                grey_a[i] += weight * static_cast<double>(a.find(name)->floats()[i]);
                grey_b[i] += weight * static_cast<double>(b.find(name)->floats()[i]);
            }
        const double expected = direct_ssim(grey_a, grey_b, width, height);
        CHECK(compare(a, b).metrics.ssim == Approx(expected).epsilon(1e-9));
    }
}

TEST_CASE("one NaN or infinity is a failure, wherever it is and even in both",
          "[measure][compare][bad-input]") {
    const Image good = noise(4, 16, 16);
    CompareOptions lax;
    lax.fail = lax.hardfail = lax.warn = 1e30;
    lax.failpercent = 100;
    lax.allowfailures = 1000;
    for (const float bad : {kNan, kInfinity, -kInfinity}) {
        Image odd = good;
        odd.channels[1].floats()[37] = bad;
        CHECK(compare(good, odd, lax).verdict == Verdict::kFailure);
        CHECK(compare(odd, good, lax).verdict == Verdict::kFailure);
        const Comparison both = compare(odd, odd, lax);
        CHECK(both.verdict == Verdict::kFailure);
        CHECK(both.counts.nan_ref + both.counts.inf_ref == 1);
        CHECK(both.counts.nan_test + both.counts.inf_test == 1);
        CHECK(both.counts.nan_ref == (std::isnan(bad) ? 1 : 0));
        // The finite rest is still measured.
        CHECK(std::isfinite(compare(good, odd).metrics.rmse));
        CHECK(compare(good, odd).metrics.max == 0);
        CHECK(compare(good, odd).metrics.ssim == 1);
    }
    Image with_z = good, odd_z = good;
    with_z.channels.push_back({"Z", std::vector<float>(256, 1)});
    odd_z.channels.push_back({"Z", std::vector<float>(256, 1)});
    odd_z.channels.back().floats()[5] = kNan;
    CHECK(compare(with_z, odd_z, lax).verdict == Verdict::kFailure);
}

TEST_CASE("hardfail holds where no pixel exceeds fail", "[measure][compare][law]") {
    const Image a = constant(16, 16, 0.5f), b = constant(16, 16, 0.505f);
    CompareOptions options = only(0.01, 0.001);
    CHECK(compare(a, b, options).verdict == Verdict::kFailure);
    CHECK(compare(a, b, options).counts.hard == 256);
    options.hardfail = 0.01;
    CHECK(compare(a, b, options).verdict == Verdict::kWarning);
    options.warn = 0.01;
    CHECK(compare(a, b, options).verdict == Verdict::kPass);
}

TEST_CASE("pixels beyond hardfail are not said to be beyond fail", "[measure][compare]") {
    const Image a = constant(16, 16, 0.5f), b = constant(16, 16, 0.75f);
    using Reasons = std::vector<std::string>;
    const std::string hard = "256 pixels differ by more than hardfail 0.125";
    CompareOptions options = only(std::numeric_limits<double>::infinity(), 0.125);
    CHECK(compare(a, b, options).reasons == Reasons{hard});
    options.failpercent = 50;
    CHECK(compare(a, b, options).reasons == Reasons{hard});
    options.fail = 0.5;
    CHECK(
        compare(a, b, options).reasons ==
        Reasons{hard, "256 pixels (100 %) differ by more than fail 0.5 or hardfail 0.125, allowed are 50 %"});
    options.fail = 0.0625;
    CHECK(compare(a, b, options).reasons ==
          Reasons{hard, "256 pixels (100 %) differ by more than fail 0.0625, allowed are 50 %"});
}

TEST_CASE("images of different make are not comparable, and the message says why",
          "[measure][compare][bad-input]") {
    const Image black = constant(64, 64, 0);
    CHECK(refusal(black, constant(32, 64, 0)).find("64x64") != std::string::npos);
    Image more = black;
    more.channels.push_back({"A", std::vector<float>(black.pixels(), 0)});
    CHECK(refusal(black, more).find("A: images cannot be compared: only the test has") == 0);
    CHECK(refusal(more, black).find("only the reference has") != std::string::npos);
    Image renamed = black;
    renamed.channels[0].name = "X";
    CHECK(refusal(black, renamed).find("R") == 0);
    Image retyped = more;
    retyped.channels[3].values = std::vector<Id>(black.pixels(), 0);
    CHECK(refusal(more, retyped).find("float") != std::string::npos);
    Image cropped = black;
    cropped.x0 = 1;
    CHECK(refusal(black, cropped).find("data window") == 0);
    Image turned = black;
    std::swap(turned.channels[0], turned.channels[2]);  // the order is free
    CHECK(refusal(black, turned).empty());

    CompareOptions options;
    options.layer = "reflect";
    CHECK_THROWS_AS(compare(black, black, options), InputError);
}

TEST_CASE("the thresholds mean what their formulas say", "[measure][compare]") {
    const Image a = constant(10, 10, 0.5f);
    const auto off = [&](std::size_t pixels, float by) {
        return picture(10, 10, [=](std::size_t i, int c) { return i < pixels && c == 1 ? 0.5f + by : 0.5f; });
    };
    CompareOptions options = only(0.01, 0.2);
    options.failpercent = 3;
    CHECK(compare(a, off(3, 0.1f), options).verdict == Verdict::kWarning);
    CHECK(compare(a, off(4, 0.1f), options).verdict == Verdict::kFailure);
    CHECK(compare(a, off(1, 0.3f), options).verdict == Verdict::kFailure);
    options.allowfailures = 2;
    CHECK(compare(a, off(2, 0.3f), options).verdict == Verdict::kWarning);
    CHECK(compare(a, off(3, 0.3f), options).verdict == Verdict::kFailure);
    options = only(0.01, 1);
    options.failrelative = 0.5;  // of a mean magnitude of about 0.55
    CHECK(compare(a, off(50, 0.1f), options).counts.fail == 0);
    CHECK(compare(a, off(50, 0.5f), options).counts.fail == 50);
    options = only(1, 1);
    options.warn = 0.05;
    options.warnpercent = 10;
    CHECK(compare(a, off(10, 0.1f), options).verdict == Verdict::kPass);
    CHECK(compare(a, off(11, 0.1f), options).verdict == Verdict::kWarning);

    Image window = off(4, 0.3f);
    window.x0 = 20;
    window.y0 = 30;
    window.width = window.height = 100;
    Image base = a;
    base.x0 = 20;
    base.y0 = 30;
    base.width = base.height = 100;
    window.channels[1].floats()[47] = 0.1f;
    const WorstPixel worst = compare(base, window).worst;
    CHECK(worst.x == 27);
    CHECK(worst.y == 34);
    CHECK(worst.channel == "G");
    CHECK(worst.test == Approx(0.1));
}

TEST_CASE("the mask compares only its optic's pixels, and must not be empty", "[measure][compare]") {
    Image a = constant(8, 8, 0.5f), b = constant(8, 8, 0.5f);
    std::vector<Id> object(64, kNone);
    for (std::size_t i = 0; i < 16; ++i) object[i] = 3;
    a.channels.push_back({"optic.object", object});
    object[16] = 3;  // the silhouette moved
    b.channels.push_back({"optic.object", object});
    for (std::size_t i = 17; i < 64; ++i) b.channels[0].floats()[i] = kNan;
    CompareOptions options;
    options.mask_object = 3;
    const Comparison masked = compare(a, b, options);
    CHECK(masked.verdict == Verdict::kPass);
    CHECK(masked.counts.pixels == 17);
    CHECK(masked.counts.masked == 47);
    b.channels[0].floats()[16] = 0.9f;
    CHECK(compare(a, b, options).verdict == Verdict::kFailure);
    CHECK(compare(a, b).verdict == Verdict::kFailure);
    options.mask_object = 4;
    CHECK_THROWS_AS(compare(a, b, options), InputError);
    CHECK_THROWS_AS(compare(constant(8, 8, 0), constant(8, 8, 0), options), InputError);
}
