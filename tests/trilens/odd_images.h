// A picture, and what is none, for tests of functions that take pictures.
#pragma once

#include <vector>

#include "support/callers_data.h"
#include "trilens/trilens.h"

namespace trilens_test {

using trilens::Id;
using trilens::Image;
using trilens::kNone;

/// A picture of 4 x 3 with all that comparisons ask for.
inline Image small_image() {
    Image image;
    image.width = image.data_width = 4;
    image.height = image.data_height = 3;
    for (const char* name : {"R", "G", "B", "A", "reflectP.X", "reflectP.Y", "reflectP.Z"})
        image.channels.push_back({name, std::vector<float>(12, 0.5f)});
    for (const char* name : {"optic.object", "reflectID.object", "reflectID.primitive"})
        image.channels.push_back({name, std::vector<Id>(12, 1)});
    return image;
}

inline std::vector<Image> odd_images() {
    std::vector<Image> all(2);
    all[0] = Image();
    all[1] = small_image();
    const auto add = [&](const auto& change) { change(all.emplace_back(small_image())); };
    for (const int n : kOddInts) {
        add([&](Image& image) { image.data_width = n; });
        add([&](Image& image) { image.data_height = n; });
        add([&](Image& image) { image.width = n, image.x0 = n; });
        add([&](Image& image) {
            image.data_width = n, image.data_height = n, image.width = n, image.height = n;
        });
    }
    for (std::size_t c = 0; c < small_image().channels.size(); ++c) {
        add([&](Image& image) { image.channels[c].values = std::vector<float>(3); });
        add([&](Image& image) { image.channels[c].values = std::vector<float>(); });
        add([&](Image& image) { image.channels[c].values = std::vector<Id>(99, kNone); });
        add([&](Image& image) {
            image.channels[c].values = std::vector<float>(12, static_cast<float>(kNaN));
        });
        add([&](Image& image) {
            image.channels[c].values = std::vector<float>(12, static_cast<float>(kInfinity));
        });
        add([&](Image& image) {
            image.channels.erase(image.channels.begin() + static_cast<std::ptrdiff_t>(c));
        });
        add([&](Image& image) { image.channels[c].name = "R"; });
    }
    return all;
}

}  // namespace trilens_test
