#include "measure/compare.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "base/math/luminance.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "measure/common/comparable.h"
#include "measure/common/statistics.h"
#include "measure/pixel/flip.h"
#include "measure/pixel/ssim.h"

namespace trilens {

namespace {

using Mask = std::vector<std::uint8_t>;

constexpr double kRelativeEpsilon = 0.01;

struct ChannelPair {
    std::string name;
    const std::vector<float>&reference, &test;

    double difference(std::size_t i) const {
        return std::abs(static_cast<double>(test[i]) - static_cast<double>(reference[i]));
    }
    double mean_magnitude(std::size_t i) const {
        return 0.5 * (std::abs(static_cast<double>(test[i])) + std::abs(static_cast<double>(reference[i])));
    }
};

ChannelPair pair_of(const Image& reference, const Image& test, const std::string& name) {
    return {name, float_channel(reference, name), float_channel(test, name)};
}

/// R, G, B, then the beauty's A where it has one.
std::vector<ChannelPair> channels_of(const Image& reference, const Image& test, const std::string& layer) {
    std::vector<ChannelPair> channels;
    for (const char* name : {"R", "G", "B"})
        channels.push_back(pair_of(reference, test, channel_of(layer, name)));
    if (layer.empty() && reference.find("A")) channels.push_back(pair_of(reference, test, "A"));
    return channels;
}

/// Whether all channels hold the same finite values: all differences are zero.
bool is_same(const std::vector<ChannelPair>& channels, std::size_t i) {
    bool same = true;
    for (const ChannelPair& channel : channels)
        same = same && channel.test[i] == channel.reference[i] && std::isfinite(channel.test[i]);
    return same;
}

// --- Values that are not finite ---

constexpr std::uint8_t kNan = 1, kInf = 2;

/// By the bits, without a branch.
bool all_finite(const std::vector<float>& values) {
    constexpr std::uint32_t kExponent = 0x7f800000;
    std::uint32_t odd = 0;
    for (const float value : values) odd |= (std::bit_cast<std::uint32_t>(value) & kExponent) == kExponent;
    return odd == 0;
}

/// Per pixel which kinds of non-finite value any float channel holds.
std::vector<std::uint8_t> non_finite(const Image& image) {
    std::vector<std::uint8_t> kinds(image.pixels(), 0), is_finite(image.channels.size(), 1);
    parallel_for(is_finite.size(), 1, [&](std::size_t first, std::size_t last) {
        for (std::size_t c = first; c < last; ++c)
            if (!image.channels[c].is_id()) is_finite[c] = all_finite(image.channels[c].floats());
    });
    for (std::size_t c = 0; c < is_finite.size(); ++c) {
        if (is_finite[c]) continue;
        const std::vector<float>& values = image.channels[c].floats();
        for (std::size_t i = 0; i < values.size(); ++i) {
            if (std::isnan(values[i]))
                kinds[i] |= kNan;
            else if (std::isinf(values[i]))
                kinds[i] |= kInf;
        }
    }
    return kinds;
}

std::size_t count_kind(const std::vector<std::uint8_t>& kinds, const Mask& mask, std::uint8_t kind) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < kinds.size(); ++i) count += mask[i] && (kinds[i] & kind);
    return count;
}

// --- Metrics ---

double ssim_of(const Image& image, const std::vector<ChannelPair>& rgb, const Mask& mask) {
    std::vector<double> reference(image.pixels()), test(image.pixels());
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        reference[i] = luminance({rgb[0].reference[i], rgb[1].reference[i], rgb[2].reference[i]});
        test[i] = luminance({rgb[0].test[i], rgb[1].test[i], rgb[2].test[i]});
    }
    return structural_similarity({image.data_width, image.data_height, reference},
                                 {image.data_width, image.data_height, test}, mask);
}

ColourPicture picture_of(const Image& image, const std::string& layer) {
    return {image.data_width, image.data_height, float_channel(image, channel_of(layer, "R")),
            float_channel(image, channel_of(layer, "G")), float_channel(image, channel_of(layer, "B"))};
}

double mean_flip(const std::vector<float>& errors, const Mask& mask) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        if (!mask[i] || std::isnan(errors[i])) continue;
        sum += static_cast<double>(errors[i]);
        ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : 0;
}

/// All but FLIP's.
Metrics metrics_of(const Image& image, const std::vector<ChannelPair>& channels, const Mask& mask) {
    double sum = 0, squares = 0, relative = 0;
    std::vector<double> largest;
    largest.reserve(image.pixels());
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        if (!mask[i]) continue;
        if (is_same(channels, i)) {
            largest.push_back(0);
            continue;
        }
        std::array<double, 3> d{};
        for (std::size_t c = 0; c < 3; ++c) d[c] = channels[c].difference(i);
        if (!std::isfinite(d[0] + d[1] + d[2])) continue;
        for (std::size_t c = 0; c < 3; ++c) {
            const double r = channels[c].reference[i];
            sum += d[c];
            squares += d[c] * d[c];
            relative += d[c] * d[c] / (r * r + kRelativeEpsilon);
        }
        largest.push_back(std::max({d[0], d[1], d[2]}));
    }

    Metrics metrics;
    const double count = std::max(1.0, 3 * static_cast<double>(largest.size()));
    metrics.mae = sum / count;
    metrics.rmse = std::sqrt(squares / count);
    metrics.relmse = relative / count;
    metrics.psnr_db =
        squares > 0 ? -10 * std::log10(squares / count) : std::numeric_limits<double>::infinity();
    metrics.ssim = ssim_of(image, channels, mask);
    const Summary summary = summarize(std::move(largest));
    metrics.max = summary.max;
    metrics.p50 = summary.p50;
    metrics.p95 = summary.p95;
    metrics.p99 = summary.p99;
    return metrics;
}

// --- Verdict ---

/// What one pixel's channels say together.
struct PixelFlags {
    bool fail = false, warn = false, hard = false;
};

PixelFlags flags_of(const std::vector<ChannelPair>& channels, std::size_t i, const CompareOptions& options) {
    PixelFlags flags;
    for (const ChannelPair& channel : channels) {
        const double d = channel.difference(i);
        if (d > options.hardfail) flags.hard = true;
        if (d > options.fail && d > options.failrelative * channel.mean_magnitude(i)) flags.fail = true;
        if (d > options.warn) flags.warn = true;
    }
    flags.fail = flags.fail || flags.hard;
    return flags;
}

void count_flags(const Image& image, const std::vector<ChannelPair>& channels, const Mask& mask,
                 const CompareOptions& options, Comparison& result) {
    double largest = 0;
    const bool may_skip = options.fail >= 0 && options.warn >= 0 && options.hardfail >= 0;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        if (!mask[i]) {
            ++result.counts.masked;
            continue;
        }
        ++result.counts.pixels;
        if (may_skip && is_same(channels, i)) continue;
        const PixelFlags flags = flags_of(channels, i, options);
        result.counts.fail += flags.fail;
        result.counts.warn += flags.warn;
        result.counts.hard += flags.hard;
        for (const ChannelPair& channel : channels) {
            const double d = channel.difference(i);
            if (!std::isfinite(d) || d <= largest) continue;
            largest = d;
            const int column = static_cast<int>(i % static_cast<std::size_t>(image.data_width));
            const int row = static_cast<int>(i / static_cast<std::size_t>(image.data_width));
            result.worst = {image.x0 + column, image.y0 + row, channel.name, channel.reference[i],
                            channel.test[i]};
        }
    }
}

template <typename... Parts>
std::string sentence(const Parts&... parts) {
    std::ostringstream text;
    (text << ... << parts);
    return text.str();
}

double percent_of(std::size_t part, std::size_t whole) {
    return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 0;
}

void judge(const CompareOptions& options, Comparison& result) {
    const CompareCounts& n = result.counts;
    const auto complain = [&](std::size_t count, const char* what, const char* where) {
        if (count > 0) result.reasons.push_back(sentence(count, " pixels hold ", what, " in the ", where));
    };
    complain(n.nan_ref, "NaN", "reference");
    complain(n.nan_test, "NaN", "test");
    complain(n.inf_ref, "an infinity", "reference");
    complain(n.inf_test, "an infinity", "test");
    if (n.hard > options.allowfailures)
        result.reasons.push_back(sentence(n.hard, " pixels differ by more than hardfail ", options.hardfail));
    // Pixels beyond hardfail fail, too: without a fail of their own they are told of already.
    if (n.fail > options.allowfailures && percent_of(n.fail, n.pixels) > options.failpercent &&
        std::isfinite(options.fail)) {
        const std::string hard =
            n.hard > 0 && options.hardfail < options.fail ? sentence(" or hardfail ", options.hardfail) : "";
        result.reasons.push_back(sentence(n.fail, " pixels (", percent_of(n.fail, n.pixels),
                                          " %) differ by more than fail ", options.fail, hard,
                                          ", allowed are ", options.failpercent, " %"));
    }
    if (!result.reasons.empty()) {
        result.verdict = Verdict::kFailure;
    } else if (percent_of(n.warn, n.pixels) > options.warnpercent) {
        result.verdict = Verdict::kWarning;
        result.reasons.push_back(sentence(n.warn, " pixels (", percent_of(n.warn, n.pixels),
                                          " %) differ by more than warn ", options.warn));
    }
}

}  // namespace

Comparison compare(const Image& reference, const Image& test, const CompareOptions& options,
                   const std::vector<float>* flip) {
    require_comparable(reference, test);
    const Mask mask = compared_pixels(reference, test, options.mask_object);
    const std::vector<ChannelPair> channels = channels_of(reference, test, options.layer);
    if (flip && flip->size() != mask.size())
        throw InputError("", "flip", "has not one error per pixel of the data window");

    Comparison result;
    count_flags(reference, channels, mask, options, result);
    const std::vector<std::uint8_t> odd_reference = non_finite(reference), odd_test = non_finite(test);
    result.counts.nan_ref = count_kind(odd_reference, mask, kNan);
    result.counts.nan_test = count_kind(odd_test, mask, kNan);
    result.counts.inf_ref = count_kind(odd_reference, mask, kInf);
    result.counts.inf_test = count_kind(odd_test, mask, kInf);
    result.metrics = metrics_of(reference, channels, mask);
    result.metrics.flip = mean_flip(flip ? *flip : layer_flip(reference, test, options.layer), mask);
    judge(options, result);
    return result;
}

std::vector<float> layer_flip(const Image& reference, const Image& test, const std::string& layer,
                              FlipReference* kept) {
    require_comparable(reference, test);
    return flip_map(picture_of(reference, layer), picture_of(test, layer), kFlipPixelsPerDegree, kept);
}

namespace {

/// By Shift, in its order.
constexpr float kShiftMarks[] = {0, 1, -1, -2};

void add_channel(Image& image, const std::string& name, std::vector<float> values) {
    image.channels.push_back({name, std::move(values)});
}

}  // namespace

void add_shift(const std::string& layer, const Displacement& displacement, Image& difference) {
    for (const std::size_t size :
         {displacement.state.size(), displacement.shift_x.size(), displacement.shift_y.size()})
        if (size != difference.pixels())
            throw InputError("", layer, "its displacement is of an image of another size");
    std::vector<float> state(displacement.state.size());
    std::ranges::transform(displacement.state, state.begin(),
                           [](Shift shift) { return kShiftMarks[static_cast<std::size_t>(shift)]; });
    add_channel(difference, layer + ".shift.X", displacement.shift_x);
    add_channel(difference, layer + ".shift.Y", displacement.shift_y);
    add_channel(difference, layer + ".shift.M", std::move(state));
}

Image make_difference(const Image& reference, const Image& test, const DifferenceOptions& options,
                      std::vector<float> flip) {
    require_comparable(reference, test);
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, options.mask_object);

    Image image{reference.width,      reference.height,      reference.x0, reference.y0,
                reference.data_width, reference.data_height, {},           {{"trilens:kind", "difference"}}};
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>& a = float_channel(reference, channel_of(options.layer, name));
        const std::vector<float>& b = float_channel(test, channel_of(options.layer, name));
        std::vector<float> signed_values(a.size(), 0), magnitudes(a.size(), 0);
        for (std::size_t i = 0; i < a.size(); ++i) {
            if (!mask[i]) continue;
            signed_values[i] = b[i] - a[i];
            magnitudes[i] = std::abs(signed_values[i]);
        }
        add_channel(image, name, std::move(signed_values));
        add_channel(image, std::string("abs.") + name, std::move(magnitudes));
    }
    add_channel(image, "mask.M", std::vector<float>(mask.begin(), mask.end()));
    if (flip.empty()) flip = layer_flip(reference, test, options.layer);
    if (flip.size() != mask.size())
        throw InputError("", "flip", "has not one error per pixel of the data window");
    for (std::size_t i = 0; i < flip.size(); ++i)
        if (!mask[i]) flip[i] = 0;
    add_channel(image, "flip.Y", std::move(flip));
    return image;
}

}  // namespace trilens
