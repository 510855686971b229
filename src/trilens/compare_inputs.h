// Images of different makers made comparable: which layer stands for a file, and which channels two images
// share.
//
//     const trilens::Image truth = trilens::read_compared_image("truth.exr");
//     const trilens::Image mine = trilens::read_compared_image("mine.exr");
//     const trilens::CommonChannels common = trilens::keep_common_channels(truth, mine);
//     for (const std::string& name : common.only_reference) std::printf("left out: %s\n", name.c_str());
#pragma once

#include <string>
#include <vector>

#include "base/image.h"

namespace trilens {

/// The image that stands for a file when pictures are compared: any that read_image_parts reads. `layer`
/// names the prefix of the channels that become R, G, B and A ("ViewLayer.Combined" of
/// "ViewLayer.Combined.R"; in a file of several parts also a part's name, alone or before the prefix).
/// Without it they are the root R, G, B of the part that has them, else the only layer with channels R, G and
/// B. Other channels of that part keep their names. Throws InputError, with the layers that there are, where
/// that is none or more than one.
Image read_compared_image(const std::string& file, const std::string& layer = "");

/// Two images with the same channels.
struct CommonChannels {
    Image reference, test;
    std::vector<std::string> only_reference, only_test;  // what was left out of each, by name
};

/// Leaves out the channels that the other image does not have, or has in another type (float, id). Older
/// names of what is seen are the newer ones ("reflect.object", "reflectID.object").
CommonChannels keep_common_channels(Image reference, Image test);

}  // namespace trilens
