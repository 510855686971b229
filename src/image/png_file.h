// PNG files, 8 bits and sRGB, without the large library of all pictures: THE door to libpng; and the chunks
// that they are made of (PNG, Third Edition, W3C, 5.3).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/description/material.h"

namespace trilens {

/// The picture of a PNG file in memory as linear Rec.709, alpha beside it, not applied. Null for what is
/// left to the library of all pictures: bytes that are no PNG, 16 bits, a gamma other than sRGB's, a colour
/// profile, an interlaced or damaged file.
std::shared_ptr<const Texture> decode_ordinary_png(std::span<const unsigned char> encoded);

/// The same of a file. Throws InputError where it cannot be read.
std::shared_ptr<const Texture> read_ordinary_png(const std::string& file);

/// What libpng finds wrong with a PNG file in memory, so that it cannot be read; none where it reads it, and
/// for bytes that are no PNG. Says nothing on stderr, as libraries that read a damaged file do.
std::optional<std::string> png_fault(std::span<const unsigned char> encoded);

/// The same of a file. Throws InputError where it cannot be read.
std::optional<std::string> png_fault(const std::string& file);

/// An 8-bit sRGB PNG of the values as they are stored, three per pixel, rows from the top. `name`: for
/// messages. Throws OutputError.
std::vector<unsigned char> encode_stored_png(const std::string& name, int width, int height,
                                             std::span<const unsigned char> stored);

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
