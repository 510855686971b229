#include "image/png_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <new>
#include <string_view>

#include "base/error.h"
#include "base/file_bytes.h"
#include "image/library_reason.h"
#include "image/srgb.h"

namespace trilens {
namespace {

constexpr std::array<unsigned char, 8> kSignature{0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};

/// Deflate shrinks nothing more than this (RFC 1951): a header that claims more is damaged or hostile.
constexpr std::size_t kLargestCompression = 1032;

std::uint32_t read32(std::span<const unsigned char> bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
           bytes[3];
}

/// 1 / 2.2 as a gAMA chunk says it, which files of sRGB hold (11.3.2).
constexpr std::uint32_t kGamma = 45455;

/// Whether the chunks before the pixels (PNG, Third Edition, W3C, 5.2 and 11) are those of an ordinary file.
bool is_ordinary(std::span<const unsigned char> png) {
    constexpr std::size_t kHeader = 8 + 8 + 13 + 4;
    if (png.size() < kHeader || !std::equal(kSignature.begin(), kSignature.end(), png.begin())) return false;
    const std::uint64_t width = read32(png.subspan(16)), height = read32(png.subspan(20));
    const unsigned char depth = png[24], interlaced = png[28];
    if (depth > 8 || interlaced) return false;
    if (width > 1u << 24 || height > 1u << 24 ||
        width * height * depth / 8 > kLargestCompression * png.size())
        return false;
    for (std::size_t at = kHeader; png.size() - at >= 12;) {
        const std::size_t size = read32(png.subspan(at));
        const std::string_view type(reinterpret_cast<const char*>(png.data()) + at + 4, 4);
        if (type == "IDAT") return true;
        if (type == "iCCP" || type == "cICP" || size > png.size() - at - 12) return false;
        if (type == "gAMA" && (size != 4 || read32(png.subspan(at + 8)) != kGamma)) return false;
        at += 12 + size;
    }
    return false;
}

/// What libpng holds on to, given back.
struct PngImage {
    png_image image{};
    PngImage() { image.version = PNG_IMAGE_VERSION; }
    ~PngImage() { png_image_free(&image); }
    PngImage(const PngImage&) = delete;
    PngImage& operator=(const PngImage&) = delete;
};

const std::array<float, 256>& linear_from_byte() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
        return values;
    }();
    return table;
}

}  // namespace

std::shared_ptr<const Texture> decode_ordinary_png(std::span<const unsigned char> encoded) {
    if (!is_ordinary(encoded)) return nullptr;
    PngImage png;
    if (!png_image_begin_read_from_memory(&png.image, encoded.data(), encoded.size())) return nullptr;
    // With alpha, because without it libpng would blend the colours with a background.
    png.image.format = PNG_FORMAT_RGBA;
    const std::size_t pixels = static_cast<std::size_t>(png.image.width) * png.image.height;
    try {
        std::vector<unsigned char> stored(4 * pixels);
        if (!png_image_finish_read(&png.image, nullptr, stored.data(), 0, nullptr)) return nullptr;
        auto texture = std::make_shared<Texture>();
        texture->width = static_cast<int>(png.image.width);
        texture->height = static_cast<int>(png.image.height);
        texture->rgb.resize(3 * pixels);
        const std::array<float, 256>& linear = linear_from_byte();
        for (std::size_t i = 0; i < pixels; ++i)
            for (std::size_t c = 0; c < 3; ++c) texture->rgb[3 * i + c] = linear[stored[4 * i + c]];
        return texture;
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

std::shared_ptr<const Texture> read_ordinary_png(const std::string& file) {
    const std::size_t size = readable_size(file);
    std::ifstream in(file, std::ios::binary);
    std::array<unsigned char, kSignature.size()> start{};
    in.read(reinterpret_cast<char*>(start.data()), start.size());
    if (!in || start != kSignature) return nullptr;
    std::vector<unsigned char> bytes(size);
    in.seekg(0);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    return in ? decode_ordinary_png(bytes) : nullptr;
}

std::vector<unsigned char> encode_stored_png(const std::string& name, int width, int height,
                                             std::span<const unsigned char> stored) {
    PngImage png;
    png.image.width = static_cast<png_uint_32>(width);
    png.image.height = static_cast<png_uint_32>(height);
    png.image.format = PNG_FORMAT_RGB;
    png.image.flags = PNG_IMAGE_FLAG_FAST;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(png.image);
    std::vector<unsigned char> bytes(size);
    if (!png_image_write_to_memory(&png.image, bytes.data(), &size, 0, stored.data(), 0, nullptr))
        throw OutputError(name, "cannot be encoded: " + library_reason(png.image.message));
    bytes.resize(size);
    return bytes;
}

}  // namespace trilens
