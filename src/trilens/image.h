// Pictures with named channels, in memory and in files.
//
//     trilens::Image image = trilens::read_image("picture.exr");
//     const trilens::Channel* red = image.find("R");
//     if (red) std::printf("%g\n", red->floats()[0]);
//     trilens::write_image("picture.png", image);
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"
#include "image/image_parts.h"
#include "image/tone.h"

namespace trilens {

/// Reads every channel of an OpenEXR file in its own type (half becomes float). Throws InputError where the
/// file cannot be used.
Image read_image(const std::string& file);

/// Writes OpenEXR, all channels to the last bit (a name that ends in ".exr"), or the beauty R G B as 8-bit
/// sRGB after exposure and tone curve (".png"); beside the name, then renamed. Metadata is kept where its
/// name starts with "trilens:". Throws UsageError for other endings and for a mapping that is none,
/// InputError for an image that is none (see check_image), OutputError where the file cannot be written.
/// OpenEXR holds the light of the scene: `tone` is not asked for it.
void write_image(const std::string& file, const Image& image, const ToneMapping& tone = {});

enum class ImageFormat { kExr, kPng };

/// What a file's name asks for. Throws UsageError for other endings than ".exr" and ".png".
ImageFormat image_format(const std::string& file);

/// The same, whatever the name ends in.
void write_image_as(const std::string& file, const Image& image, ImageFormat format,
                    const ToneMapping& tone = {});

/// The bytes of that file.
std::vector<unsigned char> encode_image_as(const Image& image, ImageFormat format,
                                           const ToneMapping& tone = {});

/// The curve of that name: "none", "reinhard", "aces" or "neutral". Throws UsageError for another.
ToneCurve tone_curve(const std::string& name);

/// The bytes of that OpenEXR file.
std::vector<unsigned char> encode_image(const Image& image);

/// Throws InputError unless the data window lies on the film and holds pixels, channels have distinct names
/// and one value per pixel, and metadata names start with "trilens:".
void check_image(const Image& image);

}  // namespace trilens
