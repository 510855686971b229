// The parts of a picture's file, whatever its format.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// A part of a picture's file.
struct ImagePart {
    std::string name;  // empty where the file gives none
    Image image;
};

/// Reads every part of any picture: of OpenEXR all channels as read_image does, of other formats (PNG, JPEG
/// and their like) one part with R, G and B in linear Rec.709 and, where any pixel is not opaque, A, which
/// the colours are not multiplied by. Throws InputError.
std::vector<ImagePart> read_image_parts(const std::string& file);

}  // namespace trilens
