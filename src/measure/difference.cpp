#include "measure/difference.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/util/error.h"
#include "measure/common/comparable.h"
#include "measure/compare.h"

namespace trilens {
namespace {

/// By Shift, in its order.
constexpr float kShiftMarks[] = {0, 1, -1, -2};

void add_channel(Image& image, const std::string& name, std::vector<float> values) {
    image.channels.push_back({name, std::move(values)});
}

}  // namespace

void add_shift(const std::string& layer, const Displacement& displacement, Image& difference) {
    for (const std::size_t size :
         {displacement.state.size(), displacement.shift_x.size(), displacement.shift_y.size()})
        if (size != difference.pixels())
            throw InputError("", layer, "its displacement is of an image of another size");
    std::vector<float> state(displacement.state.size());
    std::ranges::transform(displacement.state, state.begin(), [](Shift shift) {
        return kShiftMarks[static_cast<std::size_t>(shift)];
    });
    add_channel(difference, layer + ".shift.X", displacement.shift_x);
    add_channel(difference, layer + ".shift.Y", displacement.shift_y);
    add_channel(difference, layer + ".shift.M", std::move(state));
}

Image make_difference(const Image& reference, const Image& test, const DifferenceOptions& options,
                      std::vector<float> flip) {
    require_comparable(reference, test);
    const std::vector<std::uint8_t> mask = compared_pixels(reference, test, options.mask_object);

    Image image{reference.width,      reference.height,      reference.x0, reference.y0,
                reference.data_width, reference.data_height, {},           {{"trilens:kind", "difference"}}};
    for (const char* name : {"R", "G", "B"}) {
        const std::vector<float>& a = float_channel(reference, channel_of(options.layer, name));
        const std::vector<float>& b = float_channel(test, channel_of(options.layer, name));
        std::vector<float> signed_values(a.size(), 0), magnitudes(a.size(), 0);
        for (std::size_t i = 0; i < a.size(); ++i) {
            if (!mask[i]) continue;
            signed_values[i] = b[i] - a[i];
            magnitudes[i] = std::abs(signed_values[i]);
        }
        add_channel(image, name, std::move(signed_values));
        add_channel(image, std::string("abs.") + name, std::move(magnitudes));
    }
    add_channel(image, "mask.M", std::vector<float>(mask.begin(), mask.end()));
    if (flip.empty()) flip = layer_flip(reference, test, options.layer);
    if (flip.size() != mask.size())
        throw InputError("", "flip", "has not one error per pixel of the data window");
    for (std::size_t i = 0; i < flip.size(); ++i)
        if (!mask[i]) flip[i] = 0;
    add_channel(image, "flip.Y", std::move(flip));
    return image;
}

}  // namespace trilens
