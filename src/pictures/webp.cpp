#include "pictures/webp.h"

#include <cstddef>
#include <cstring>
#include <string_view>

namespace trilens {
namespace {

constexpr std::size_t kFileHeader = 12, kChunkHeader = 8;

std::string_view text_at(std::span<const unsigned char> bytes, std::size_t at, std::size_t count) {
    return {reinterpret_cast<const char*>(bytes.data()) + at, count};
}

}  // namespace

bool is_webp(std::span<const unsigned char> encoded) {
    return encoded.size() >= kFileHeader && text_at(encoded, 0, 4) == "RIFF" &&
           text_at(encoded, 8, 4) == "WEBP";
}

std::vector<unsigned char> webp_without_alpha(std::span<const unsigned char> encoded) {
    constexpr unsigned char kHasAlpha = 0x10;  // in the fifth byte of VP8L, in the first of VP8X
    std::vector<unsigned char> opaque(encoded.begin(), encoded.end());
    for (std::size_t at = kFileHeader; at + kChunkHeader < opaque.size();) {
        const std::string_view kind = text_at(encoded, at, 4);
        std::size_t length = 0;
        for (std::size_t k = 4; k-- > 0;) length = length << 8 | opaque[at + 4 + k];
        const std::size_t payload = at + kChunkHeader;
        const std::size_t there = opaque.size() - payload;
        if (kind == "VP8X") opaque[payload] &= static_cast<unsigned char>(~kHasAlpha);
        if (kind == "VP8L" && there > 4) opaque[payload + 4] &= static_cast<unsigned char>(~kHasAlpha);
        // Chunks of unknown kinds are passed over.
        if (kind == "ALPH") std::memcpy(&opaque[at], "none", 4);
        if (length >= there) break;
        at = payload + length + length % 2;
    }
    return opaque;
}

}  // namespace trilens
