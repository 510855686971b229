// The difference of two images as an image to look at.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/image/image.h"
#include "base/util/ids.h"
#include "measure/displacement/displacement.h"

namespace trilens {

struct DifferenceOptions {
    std::string layer;              // "": the beauty; as in CompareOptions
    std::optional<Id> mask_object;  // as in CompareOptions
};

/// An image with the window of the two and float channels
///   R G B        test - reference of the layer's R, G, B; zero outside the mask
///   abs.R G B    its magnitude
///   mask.M       1 where the pixel is compared, else 0
///   flip.Y       the error of flip.h, 0 (none to be seen) to 1; zero outside the mask
/// Throws InputError where compare() would.
/// `flip`: the errors of layer_flip for the same images and layer, where they are known; InputError where
/// they are not as many as pixels.
Image make_difference(const Image& reference, const Image& test, const DifferenceOptions& options = {},
                      std::vector<float> flip = {});

/// Adds what `layer` ("reflect", "refract") shows, moved, to the difference of the same two images:
///   LAYER.shift.X Y    Displacement::shift_x, shift_y, in pixels
///   LAYER.shift.M      1 found, -1 lost, -2 unmeasured, 0 nothing seen
/// Throws InputError for a displacement of images of another size.
void add_shift(const std::string& layer, const Displacement& displacement, Image& difference);

}  // namespace trilens
