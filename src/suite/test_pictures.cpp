#include "suite/test_pictures.h"

#include <cmath>
#include <functional>
#include <limits>

#include "base/util/error.h"
#include "measure/compare_layers.h"
#include "measure/difference.h"
#include "report/text.h"

namespace trilens {
namespace {

PagePicture picture_or_reason(const std::string& caption, const std::function<PagePicture()>& make) {
    try {
        return make();
    } catch (const InputError& error) {
        return {caption + ": " + error.what(), 0, 0, {}, {}, false};
    }
}

double value_of(const std::vector<NamedMetric>& metrics, const std::string& name) {
    for (const NamedMetric& metric : metrics)
        if (metric.name == name) return metric.value.value_or(0);
    return 0;
}

/// The layer's R, G, B as an image's own, so that it is seen as it is compared.
Image shown(const Image& image, const std::string& layer) {
    if (layer.empty()) return image;
    Image one = image;
    one.channels.clear();
    for (const char* colour : {"R", "G", "B"})
        if (const Channel* channel = image.find(layer + "." + colour))
            one.channels.push_back({colour, channel->values});
    return one;
}

PagePicture displacement_of(const Displacement& displacement, const std::string& layer, int width) {
    std::vector<float> pixels(displacement.state.size(), std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (displacement.state[i] == Shift::kFound)
            pixels[i] = std::hypot(displacement.shift_x[i], displacement.shift_y[i]);
        else if (displacement.state[i] == Shift::kLost)
            pixels[i] = std::numeric_limits<float>::infinity();
    }
    return displacement_picture(pixels, width, {}, "displacement, " + layer + "; grey: none, orange: lost");
}

std::vector<PagePicture> differences_of(const Judgement& judgement, const RenderTest& test) {
    const Image &reference = judgement.images->reference, &picture = judgement.images->test;
    std::vector<PagePicture> pictures;
    const double largest = value_of(judgement.metrics, "max"), flip = value_of(judgement.metrics, "rgb_flip");
    pictures.push_back(picture_or_reason("difference", [&] {
        const double scale = difference_scale(largest);
        return difference_picture(
            shown(picture, test.compare.layer), shown(reference, test.compare.layer), scale,
            "|new − reference| × " + shortest_text(scale) + ", largest " + rounded_text(largest, 2));
    }));
    pictures.push_back(picture_or_reason("FLIP", [&] {
        const Image difference =
            make_difference(reference, picture, {test.compare.layer, test.compare.mask_object});
        return share_picture(difference.find("flip.Y")->floats(), difference.data_width,
                             "FLIP, from 0 (dark) to 1 (yellow), mean " + rounded_text(flip, 3));
    }));
    for (const LayerComparison& layer :
         compare_layers(reference, picture, {test.radius, test.compare.mask_object}))
        if (layer.displacement && layer.displacement->coverage)
            pictures.push_back(displacement_of(*layer.displacement, layer.layer, picture.data_width));
    return pictures;
}

}  // namespace

TestPictures test_pictures(const std::string& against, const Image& reference, const Image& picture,
                           const Judgement& judgement, const RenderTest& test) {
    TestPictures pictures;
    pictures.against = against;
    const std::string caption = "reference (" + against + ")";
    pictures.reference = picture_or_reason(
        caption, [&] { return beauty_picture(shown(reference, test.compare.layer), caption); });
    pictures.picture =
        picture_or_reason("new", [&] { return beauty_picture(shown(picture, test.compare.layer), "new"); });
    if (!judgement.metrics.empty()) pictures.differences = differences_of(judgement, test);
    return pictures;
}

}  // namespace trilens
