// The chunks that a PNG file is made of (PNG, Third Edition, W3C, 5.3).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace trilens {

using Bytes = std::vector<unsigned char>;

inline constexpr std::array<unsigned char, 8> kPngSignature{0x89, 'P', 'N', 'G', 0x0d, 0x0a, 0x1a, 0x0a};

struct PngChunk {
    std::string_view type;
    std::span<const unsigned char> data;
};

/// A number as PNG has it: the highest byte first.
void put32(Bytes& bytes, std::uint32_t value);
/// Of the first four bytes.
std::uint32_t read32(std::span<const unsigned char> bytes);

/// Adds the chunk, with length and checksum.
void put_png_chunk(Bytes& file, const PngChunk& chunk);

}  // namespace trilens
