// Small pictures to compare.
#pragma once

#include <cstddef>
#include <functional>
#include <random>
#include <utility>
#include <vector>

#include "base/image/image.h"
#include "measure/compare.h"

namespace trilens_test {

using trilens::CompareOptions;
using trilens::Image;

/// R, G and B by a function of pixel and channel (0, 1, 2).
inline Image picture(int width, int height,
                     const std::function<float(std::size_t pixel, int channel)>& value) {
    Image image;
    image.width = image.data_width = width;
    image.height = image.data_height = height;
    int c = 0;
    for (const char* name : {"R", "G", "B"}) {
        std::vector<float> values(image.pixels());
        for (std::size_t i = 0; i < values.size(); ++i) values[i] = value(i, c);
        image.channels.push_back({name, values});
        ++c;
    }
    return image;
}

inline Image constant(int width, int height, float value) {
    return picture(width, height, [=](std::size_t, int) { return value; });
}

inline Image noise(unsigned seed, int width, int height, float low = 0, float high = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> number(low, high);
    return picture(width, height, [&](std::size_t, int) { return number(random); });
}

/// Nothing is tolerated beyond `fail`.
inline CompareOptions only(double fail, double hardfail) {
    CompareOptions options;
    options.fail = fail;
    options.hardfail = hardfail;
    options.failpercent = 0;
    options.failrelative = 0;
    return options;
}

}  // namespace trilens_test
