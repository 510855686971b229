#include "image/png_file.h"

#include <png.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

#include "base/files/files.h"
#include "base/util/error.h"
#include "base/util/overwritten.h"
#include "image/tone.h"
#include "image/zlib_stream.h"

namespace trilens {
namespace {

/// Deflate shrinks nothing more than this (RFC 1951): a header that claims more is damaged or hostile.
constexpr std::size_t kMostInflated = 1032;

/// The length of a chunk is below 2^31 (5.3).
constexpr std::size_t kMostInChunk = 0x7fffffff;

/// 1 / 2.2 as a gAMA chunk says it, which files of sRGB hold (11.3.2).
constexpr std::uint32_t kGamma = 45455;

constexpr std::size_t kHeader = 8 + 8 + 13 + 4;  // signature and first chunk

bool is_png(std::span<const unsigned char> bytes) {
    return bytes.size() >= kPngSignature.size() &&
           std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin());
}

/// All of a PNG file; nothing of another one.
std::vector<unsigned char> png_bytes(const std::string& file) {
    const std::size_t size = readable_size(file);
    std::ifstream in(file, std::ios::binary);
    std::vector<unsigned char> bytes(kPngSignature.size());
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!in || !is_png(bytes)) return {};
    bytes.resize(size);
    in.seekg(0);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    return in ? bytes : std::vector<unsigned char>();
}

/// Whether the header, which is there, claims more pixels than the file's bytes can hold.
bool claims_too_much(std::span<const unsigned char> png) {
    const std::uint64_t width = read32(png.subspan(16)), height = read32(png.subspan(20)), depth = png[24];
    return width > 1u << 24 || height > 1u << 24 || width * height * depth / 8 > kMostInflated * png.size();
}

/// Whether the chunks before the pixels (PNG, Third Edition, W3C, 5.2 and 11) are those of an ordinary file.
bool is_ordinary(std::span<const unsigned char> png) {
    if (!is_png(png) || png.size() < kHeader) return false;
    const unsigned char depth = png[24], interlaced = png[28];
    if (depth > 8 || interlaced || claims_too_much(png)) return false;
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
    const bool has_alpha = (png.image.format & PNG_FORMAT_FLAG_ALPHA) != 0;
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
        for (std::size_t i = 0; has_alpha && i < pixels; ++i)
            texture->alpha.push_back(static_cast<float>(stored[4 * i + 3]) / 255.0F);
        texture->drop_opaque_alpha();
        return texture;
    } catch (const std::bad_alloc&) {
        return nullptr;
    }
}

std::optional<std::string> png_fault(std::span<const unsigned char> encoded) {
    if (!is_png(encoded)) return std::nullopt;
    if (encoded.size() < kHeader) return "ends in its header";
    if (claims_too_much(encoded)) return "claims more pixels than it can hold";
    PngImage png;
    if (!png_image_begin_read_from_memory(&png.image, encoded.data(), encoded.size()))
        return png.image.message;
    png.image.format = PNG_FORMAT_RGBA;
    std::vector<unsigned char> stored(PNG_IMAGE_SIZE(png.image));
    if (!png_image_finish_read(&png.image, nullptr, stored.data(), 0, nullptr)) return png.image.message;
    return std::nullopt;
}

std::optional<std::string> png_fault(const std::string& file) {
    return png_fault(png_bytes(file));
}

std::shared_ptr<const Texture> read_ordinary_png(const std::string& file) {
    return decode_ordinary_png(png_bytes(file));
}

std::vector<unsigned char> encode_stored_png(const std::string& name, int width, int height,
                                             std::span<const unsigned char> stored) {
    constexpr unsigned char kDepth = 8, kColours = 2, kPerceptual = 0, kNoFilter = 0, kUp = 2;
    const std::size_t row = 3 * static_cast<std::size_t>(width), rows = static_cast<std::size_t>(height);
    // Each byte as its difference from the one above.
    Overwritten<unsigned char> lines((row + 1) * rows);
    for (std::size_t y = 0; y < rows; ++y) {
        unsigned char* const to = &lines[y * (row + 1)];
        const unsigned char *const from = &stored[y * row], *const above = from - (y > 0 ? row : 0);
        to[0] = y > 0 ? kUp : kNoFilter;
        for (std::size_t i = 0; i < row; ++i)
            to[i + 1] = static_cast<unsigned char>(from[i] - (y > 0 ? above[i] : 0));
    }
    // Where nothing shrinks deflate stores: five bytes for a block of at most 65,535 (RFC 1951, 3.2.4).
    constexpr std::size_t kAround = 64, kLeastBlock = 4096, kOfBlock = 5;
    Overwritten<unsigned char> room(lines.size() + kAround + kOfBlock * (lines.size() / kLeastBlock));
    const std::span<const unsigned char> packed(
        room.data(), deflate({lines.data(), lines.size()}, {room.data(), room.size()}));
    if (packed.empty() || packed.size() > kMostInChunk) throw OutputError(name, "is too large for a PNG");

    Bytes header;
    put32(header, static_cast<std::uint32_t>(width));
    put32(header, static_cast<std::uint32_t>(height));
    header.insert(header.end(), {kDepth, kColours, 0, 0, 0});
    Bytes file(kPngSignature.begin(), kPngSignature.end());
    put_png_chunk(file, {"IHDR", header});
    put_png_chunk(file, {"sRGB", std::array{kPerceptual}});
    put_png_chunk(file, {"IDAT", packed});
    put_png_chunk(file, {"IEND", {}});
    return file;
}

void put32(Bytes& bytes, std::uint32_t value) {
    for (const int shift : {24, 16, 8, 0}) bytes.push_back(static_cast<unsigned char>(value >> shift));
}

std::uint32_t read32(std::span<const unsigned char> bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 |
           bytes[3];
}

void put_png_chunk(Bytes& file, const PngChunk& chunk) {
    put32(file, static_cast<std::uint32_t>(chunk.data.size()));
    const std::size_t first = file.size();
    file.insert(file.end(), chunk.type.begin(), chunk.type.end());
    file.insert(file.end(), chunk.data.begin(), chunk.data.end());
    put32(file, png_checksum(std::span(file).subspan(first)));
}

}  // namespace trilens
