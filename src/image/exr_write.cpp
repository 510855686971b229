// Images as whole OpenEXR files.
#include "base/check.h"
#include "base/file_bytes.h"
#include "image/exr_strips.h"
#include "image/image_io.h"

namespace trilens {

std::vector<unsigned char> encode_exr(const std::string& name, const Image& image) {
    for (const Channel& channel : image.channels) {
        const std::size_t size = channel.is_id() ? channel.ids().size() : channel.floats().size();
        TRILENS_CHECK(size == image.pixels(), "a channel has one value per pixel of the data window");
    }
    ExrStrips strips(name, image);
    strips.add(image.channels, 0, image.data_height);
    return strips.finish();
}

void write_exr(const std::string& file, const Image& image) {
    replace_file(file, encode_exr(file, image));
}

}  // namespace trilens
