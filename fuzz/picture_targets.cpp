// Fuzz targets of pictures: OpenEXR as compare reads it, and textures.
#include <cmath>
#include <cstring>

#include "fuzz/target.h"
#include "image/image_io.h"
#include "trilens/compare.h"
#include "trilens/image.h"

using namespace trilens;

namespace trilens_fuzz {
namespace {

/// A small file that asks for a large picture costs what a large picture costs; that is no defect, and no
/// fuzzer's business.
constexpr std::size_t kMostPixels = 1 << 16;

bool same_values(const Channel& a, const Channel& b) {
    if (a.name != b.name || a.is_id() != b.is_id()) return false;
    if (a.is_id()) return a.ids() == b.ids();
    return a.floats().size() == b.floats().size() &&
           std::memcmp(a.floats().data(), b.floats().data(), 4 * a.floats().size()) == 0;  // NaN too
}

/// What is written is what is read, to the last bit.
void require_round_trip(const Image& image) {
    const std::vector<unsigned char> bytes = encode_image(image);
    const Image again =
        read_image(put_file("again.exr", {reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
    require(again.width == image.width && again.height == image.height && again.x0 == image.x0 &&
                again.y0 == image.y0 && again.data_width == image.data_width &&
                again.data_height == image.data_height,
            "a picture's windows are others once it is written");
    require(again.channels.size() == image.channels.size(), "a picture loses channels when it is written");
    for (const Channel& channel : image.channels) {
        const Channel* other = again.find(channel.name);
        require(other && same_values(channel, *other), "a channel is another once it is written");
    }
    require(encode_image(again) == bytes, "a picture that was written is written otherwise");
}

/// compare(a, a) finds nothing, and a and b are as far apart as b and a.
void require_measure(const Image& image) {
    const Comparison same = compare(image, image);
    require(same.metrics.rmse == 0 && same.metrics.max == 0 && same.metrics.flip == 0,
            "a picture differs from itself");
    Image other = image;
    for (Channel& channel : other.channels)
        if (!channel.is_id())
            for (float& value : channel.floats()) value = 0.75f * value + 0.125f;
    const Comparison there = compare(image, other), back = compare(other, image);
    const auto equal = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    require(equal(there.metrics.rmse, back.metrics.rmse) && equal(there.metrics.max, back.metrics.max) &&
                equal(there.metrics.mae, back.metrics.mae),
            "a and b are otherwise apart than b and a");
}

}  // namespace

Answer exr_file(std::string_view bytes) {
    const std::string file = put_file("fuzzed.exr", bytes);
    return answer([&] {
        const Image image = read_image(file);
        for (const Channel& channel : image.channels)
            require((channel.is_id() ? channel.ids().size() : channel.floats().size()) == image.pixels(),
                    "a channel without a value for each pixel");
        if (image.pixels() > kMostPixels) return;
        require_round_trip(image);
        require_measure(image);
    });
}

Answer png_file(std::string_view bytes) {
    return answer([&] {
        const std::span<const unsigned char> encoded(reinterpret_cast<const unsigned char*>(bytes.data()),
                                                     bytes.size());
        const auto texture = decode_texture(encoded, "fuzzed.png");
        require(texture != nullptr, "neither a texture nor a word");
        require(texture->width > 0 && texture->height > 0, "a texture without texels");
        require(texture->rgb.size() ==
                    3 * static_cast<std::size_t>(texture->width) * static_cast<std::size_t>(texture->height),
                "a texture without a value for each texel");
    });
}

}  // namespace trilens_fuzz
