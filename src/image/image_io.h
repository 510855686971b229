// Files of pictures: THE door to OpenImageIO.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "base/appearance.h"
#include "image/image.h"

namespace trilens {

/// Writes one part, scan lines, zip, float32 and uint32 channels in their native types; beside its name, then
/// renamed. The file's bytes depend on the image alone (DateTime is fixed). Throws OutputError.
void write_exr(const std::string& file, const Image& image);

/// Reads every channel of the only part in its native type (half becomes float). Throws InputError: missing, not an
/// image, truncated, more than one part, a channel type that is neither float nor uint.
Image read_exr(const std::string& file);

/// Reads any picture that OpenImageIO knows as linear Rec.709: 8 and 16 bit integer files are taken as sRGB,
/// float files as linear. One channel becomes grey; alpha is dropped. Throws InputError.
std::shared_ptr<const Texture> read_texture(const std::string& file);
std::shared_ptr<const Texture> decode_texture(std::span<const unsigned char> encoded, const std::string& name);

/// An 8-bit sRGB PNG of linear RGB triples, rows from the top; values are clamped to 0..1 before encoding.
/// Beside its name, then renamed. Throws OutputError.
void write_png(const std::string& file, int width, int height, std::span<const float> rgb);

/// The same PNG as bytes in memory.
std::vector<unsigned char> encode_png(int width, int height, std::span<const float> rgb);

/// Sets the thread counts of OpenImageIO and OpenEXR; 0 means all.
void set_image_threads(int threads);

/// "OpenImageIO 2.4.7.1": for `trilens info`.
std::string image_library_version();

}  // namespace trilens
