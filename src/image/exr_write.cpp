// Images as whole OpenEXR files.
#include "base/files/atomic_file.h"
#include "base/util/check.h"
#include "image/exr_strips.h"
#include "image/image_io.h"

namespace trilens {
namespace {

std::vector<unsigned char> encode(const std::string& name, const Image& image, ExrStrips::Writer writer) {
    for (const Channel& channel : image.channels) {
        const std::size_t size = channel.is_id() ? channel.ids().size() : channel.floats().size();
        TRILENS_CHECK(size == image.pixels(), "a channel has one value per pixel of the data window");
    }
    ExrStrips strips(name, image, std::move(writer));
    strips.add(image.channels, 0, image.data_height);
    return strips.finish();
}

}  // namespace

std::vector<unsigned char> encode_exr(const std::string& name, const Image& image) {
    return encode(name, image, nullptr);
}

void write_exr(const std::string& file, const Image& image) {
    NewFile made(file);
    encode(file, image,
           [&](std::uint64_t at, std::span<const unsigned char> bytes) { made.write(at, bytes); });
    made.commit();
}

}  // namespace trilens
