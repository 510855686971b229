#include "image/image_parts.h"

#include <utility>

#include "image/image_io.h"

namespace trilens {
namespace {

Image image_of(const Texture& texture) {
    Image image;
    image.width = image.data_width = texture.width;
    image.height = image.data_height = texture.height;
    for (std::size_t c = 0; c < 3; ++c) {
        std::vector<float> values(image.pixels());
        for (std::size_t p = 0; p < values.size(); ++p) values[p] = texture.rgb[3 * p + c];
        image.channels.push_back({std::string(1, "RGB"[c]), std::move(values)});
    }
    if (!texture.alpha.empty()) image.channels.push_back({"A", texture.alpha});
    return image;
}

}  // namespace

std::vector<ImagePart> read_image_parts(const std::string& file) {
    std::vector<ImagePart> parts;
    if (!is_exr_file(file)) {
        parts.push_back({"", image_of(*read_texture(file))});
        return parts;
    }
    for (auto& [name, image] : read_exr_parts(file)) parts.push_back({name, std::move(image)});
    return parts;
}

}  // namespace trilens
