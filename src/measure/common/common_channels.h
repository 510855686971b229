// Which channels two images share, so that images of different makers can be compared.
#pragma once

#include <string>
#include <vector>

#include "base/image/image.h"

namespace trilens {

/// Two images with the same channels.
struct CommonChannels {
    Image reference, test;
    std::vector<std::string> only_reference, only_test;  // what was left out of each, by name
};

/// Leaves out the channels that the other image does not have, or has in another type (float, id). Older
/// names of what is seen are the newer ones ("reflect.object", "reflectID.object").
CommonChannels keep_common_channels(Image reference, Image test);

}  // namespace trilens
