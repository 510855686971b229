#include "image/png_strips.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/math/srgb.h"
#include "base/util/check.h"
#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/png_file.h"

namespace trilens {
namespace {

constexpr std::size_t kPixelsPerTask = 1 << 14;

std::uint8_t stored_from_linear(double value) {
    return static_cast<std::uint8_t>(std::lround(255 * srgb_from_linear(value)));
}

/// The same by tables: which value the floats of a bucket start with, and where each value starts.
class StoredTable {
  public:
    StoredTable() {
        for (std::size_t b = 0; b < first_.size(); ++b)
            first_[b] = stored_from_linear(static_cast<double>(start_of(static_cast<std::uint32_t>(b))));
        for (int v = 1; v < 256; ++v) {
            std::uint32_t low = 0, high = std::bit_cast<std::uint32_t>(1.0f);
            while (high - low > 1) {
                const std::uint32_t middle = (low + high) / 2;
                const bool reached =
                    stored_from_linear(static_cast<double>(std::bit_cast<float>(middle))) >= v;
                (reached ? high : low) = middle;
            }
            start_[static_cast<std::size_t>(v)] = std::bit_cast<float>(high);
        }
        start_[256] = std::numeric_limits<float>::infinity();
    }

    std::uint8_t operator()(float value) const {
        if (!(value > 0)) return 0;
        const float inside = std::min(value, 1.0f);
        std::size_t stored = first_[std::bit_cast<std::uint32_t>(inside) >> kShift];
        while (inside >= start_[stored + 1]) ++stored;
        return static_cast<std::uint8_t>(stored);
    }

  private:
    static constexpr int kShift = 16;  // of a float's bits: a bucket spans a 128th of its values
    static float start_of(std::uint32_t bucket) { return std::bit_cast<float>(bucket << kShift); }

    std::array<std::uint8_t, (std::bit_cast<std::uint32_t>(1.0f) >> kShift) + 1> first_{};
    std::array<float, 257> start_{};
};

}  // namespace

void store_srgb(std::span<const float> linear, std::span<unsigned char> stored) {
    static const StoredTable stored_of;
    for (std::size_t i = 0; i < linear.size(); ++i) stored[i] = stored_of(linear[i]);
}

PngStrips::PngStrips(const std::string& name, const Image& layout, const ToneMapping& tone)
    : name_(name), tone_(tone), width_(layout.data_width), height_(layout.data_height) {
    check_tone_mapping(tone);
    std::size_t c = 0;
    for (const char* colour : {"R", "G", "B"}) {
        const Channel* channel = layout.find(colour);
        if (!channel || channel->is_id()) throw InputError("", colour, "a picture needs R, G and B");
        channel_[c++] = static_cast<std::size_t>(channel - layout.channels.data());
    }
    stored_.resize(3 * layout.pixels());
}

void PngStrips::add(const std::vector<Channel>& channels, int rows) {
    TRILENS_CHECK(rows >= 0 && next_row_ + rows <= height_, "strips end where the data window ends");
    const std::size_t width = static_cast<std::size_t>(width_),
                      count = static_cast<std::size_t>(rows) * width;
    unsigned char* const to = stored_.data() + 3 * width * static_cast<std::size_t>(next_row_);
    std::array<const float*, 3> light{};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::vector<float>& values = channels[channel_[c]].floats();
        TRILENS_CHECK(values.size() >= count, "a channel has one value per pixel");
        light[c] = values.data();
    }
    const bool as_it_is = tone_.curve == ToneCurve::kLinear && tone_.exposure == 0;
    parallel_for(count, kPixelsPerTask, [&](std::size_t from, std::size_t end) {
        for (std::size_t p = from; p < end; ++p) {
            std::array<float, 3> rgb{light[0][p], light[1][p], light[2][p]};
            if (!as_it_is) {
                const Vec3 shown = tone_mapped(Vec3(rgb[0], rgb[1], rgb[2]), tone_);
                for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<float>(shown[static_cast<int>(c)]);
            }
            store_srgb(rgb, {to + 3 * p, 3});
        }
    });
    next_row_ += rows;
}

std::vector<unsigned char> PngStrips::finish() const {
    TRILENS_CHECK(next_row_ == height_, "every row of the data window has come");
    return encode_stored_png(name_, width_, height_, {stored_.data(), stored_.size()});
}

}  // namespace trilens
