#include "view/pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace trilens {
namespace {

std::uint8_t byte_of(double share) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(share, 0.0, 1.0) * 255));
}

/// sRGB's transfer function by a table: a byte is right to half a step in all but a few of its 4096 places.
std::uint8_t srgb_byte(double linear) {
    static const auto kTable = [] {
        std::array<std::uint8_t, 4097> table{};
        for (std::size_t i = 0; i < table.size(); ++i)
            table[i] = byte_of(srgb_from_linear(static_cast<double>(i * i) / (4096.0 * 4096.0)));
        return table;
    }();
    // Square roots space the places evenly where the function is steep.
    if (!(linear > 0)) return 0;
    return kTable[static_cast<std::size_t>(std::lround(std::sqrt(std::min(linear, 1.0)) * 4096))];
}

Pixels blank(const Image& image) {
    Pixels pixels{image.data_width, image.data_height, {}};
    pixels.rgba.assign(image.pixels() * 4, 0);
    return pixels;
}

std::array<const Channel*, 3> colours_of(const Image& image, const std::string& layer) {
    return {image.find(channel_of(layer, "R")), image.find(channel_of(layer, "G")),
            image.find(channel_of(layer, "B"))};
}

void put(Pixels& pixels, std::size_t at, const std::array<std::uint8_t, 4>& rgba) {
    std::copy(rgba.begin(), rgba.end(), pixels.rgba.begin() + static_cast<std::ptrdiff_t>(4 * at));
}

}  // namespace

Pixels tone_pixels(const Image& image, const std::string& layer, const ToneMapping& tone) {
    Pixels pixels = blank(image);
    const auto [r, g, b] = colours_of(image, layer);
    const bool plain = tone.exposure == 0 && tone.curve == ToneCurve::kLinear;
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        Vec3 colour(0);
        if (r && g && b) colour = {r->floats()[i], g->floats()[i], b->floats()[i]};
        if (!plain) colour = tone_mapped(colour, tone);
        put(pixels, i, {srgb_byte(colour.x), srgb_byte(colour.y), srgb_byte(colour.z), 255});
    }
    return pixels;
}

Pixels difference_pixels(const Image& reference, const Image& test, const std::string& layer, double scale) {
    const Image difference =
        make_difference(reference, test, {layer, std::nullopt}, std::vector<float>(reference.pixels(), 0.0f));
    Pixels pixels = blank(difference);
    const auto& r = float_channel(difference, "abs.R");
    const auto& g = float_channel(difference, "abs.G");
    const auto& b = float_channel(difference, "abs.B");
    for (std::size_t i = 0; i < difference.pixels(); ++i)
        put(pixels, i, {srgb_byte(scale * r[i]), srgb_byte(scale * g[i]), srgb_byte(scale * b[i]), 255});
    return pixels;
}

std::array<std::uint8_t, 3> heat_colour(double share) {
    const double s = std::clamp(share, 0.0, 1.0);
    return {byte_of(3 * s), byte_of(3 * s - 1), byte_of(3 * s - 2)};
}

Pixels heat_pixels(std::span<const float> values, int width, int height, double most) {
    Pixels pixels{width, height, std::vector<std::uint8_t>(values.size() * 4, 255)};
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto colour =
            std::isnan(values[i]) ? std::array<std::uint8_t, 3>{60, 60, 60} : heat_colour(values[i] / most);
        put(pixels, i, {colour[0], colour[1], colour[2], 255});
    }
    return pixels;
}

std::vector<float> displacement_lengths(const std::vector<LayerComparison>& layers, std::size_t pixels) {
    std::vector<float> lengths(pixels, std::numeric_limits<float>::quiet_NaN());
    for (const LayerComparison& layer : layers) {
        if (!layer.displacement) continue;
        const Displacement& moved = *layer.displacement;
        for (std::size_t i = 0; i < std::min(pixels, moved.state.size()); ++i)
            if (moved.state[i] == Shift::kFound)
                lengths[i] = std::fmax(lengths[i], std::hypot(moved.shift_x[i], moved.shift_y[i]));
    }
    return lengths;
}

double scale_end(std::span<const float> values) {
    std::vector<float> known;
    for (const float value : values)
        if (std::isfinite(value) && value > 0) known.push_back(value);
    if (known.empty()) return 1;
    const auto high = known.begin() + static_cast<std::ptrdiff_t>((known.size() - 1) * 99 / 100);
    std::nth_element(known.begin(), high, known.end());
    const double step = std::pow(10, std::floor(std::log10(*high)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (*high <= factor * step) return factor * step;
    return 10 * step;
}

Pixels overlay_pixels(const Image& image, bool facets, bool method) {
    Pixels pixels = blank(image);
    const Channel* facet = image.find("optic.facet");
    const Channel* object = image.find("optic.object");
    const Channel* drawn = image.find("stat.method");
    const auto width = static_cast<std::size_t>(image.data_width);
    for (std::size_t i = 0; i < image.pixels(); ++i) {
        if (!object || !object->is_id() || object->ids()[i] == kNone) continue;
        if (method && drawn) {
            const double m = drawn->is_id() ? drawn->ids()[i] : static_cast<double>(drawn->floats()[i]);
            put(pixels, i,
                m == 0   ? std::array<std::uint8_t, 4>{0, 200, 60, 90}
                : m == 1 ? std::array<std::uint8_t, 4>{255, 200, 0, 110}
                         : std::array<std::uint8_t, 4>{255, 40, 40, 110});
        }
        if (!facets || !facet || !facet->is_id()) continue;
        const auto differs = [&](std::size_t other) {
            return facet->ids()[i] != facet->ids()[other] || object->ids()[i] != object->ids()[other];
        };
        const bool right = (i + 1) % width != 0 && differs(i + 1);
        const bool below = i + width < image.pixels() && differs(i + width);
        if (right || below) put(pixels, i, {255, 255, 255, 140});
    }
    return pixels;
}

Image image_of(const Pixels& pixels) {
    Image image;
    image.width = image.data_width = pixels.width;
    image.height = image.data_height = pixels.height;
    for (const char* name : {"R", "G", "B"}) {
        const std::size_t place = image.channels.size();
        std::vector<float> values(image.pixels());
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(linear_from_srgb(pixels.rgba[4 * i + place] / 255.0));
        image.channels.push_back({name, std::move(values)});
    }
    return image;
}

}  // namespace trilens
