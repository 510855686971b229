// Ordinary PNG files, 8 bits and sRGB, without the large library of all pictures: THE door to libpng.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/description/texture.h"

namespace trilens {

/// The picture of a PNG file in memory as linear Rec.709, alpha dropped and not applied. Null for what is
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

}  // namespace trilens
