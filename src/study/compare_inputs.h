// Images of different makers made comparable: which layer stands for a file.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// The image that stands for a file when pictures are compared: any that read_image_parts reads. `layer`
/// names the prefix of the channels that become R, G, B and A ("ViewLayer.Combined" of
/// "ViewLayer.Combined.R"; in a file of several parts also a part's name, alone or before the prefix).
/// Without it they are the root R, G, B of the part that has them, else the only layer with channels R, G and
/// B. Other channels of that part keep their names. Throws InputError, with the layers that there are, where
/// that is none or more than one.
Image read_compared_image(const std::string& file, const std::string& layer = "");

}  // namespace trilens
