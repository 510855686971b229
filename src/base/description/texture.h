// A picture to look up, as materials and the background have it.
#pragma once

#include <vector>

namespace trilens {

/// A picture to look up: linear Rec.709, rows from the top, three floats per texel.
struct Texture {
    int width = 0, height = 0;
    std::vector<float> rgb;
};

}  // namespace trilens
