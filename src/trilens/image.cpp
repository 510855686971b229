#include "trilens/image.h"

#include <set>
#include <utility>

#include "base/files/files.h"
#include "base/util/error.h"
#include "image/image_io.h"
#include "image/png_strips.h"

namespace trilens {
namespace {

std::vector<unsigned char> encode_beauty(const std::string& name, const Image& image,
                                         const ToneMapping& tone) {
    PngStrips strips(name, image, tone);
    strips.add(image.channels, image.data_height);
    return strips.finish();
}

}  // namespace

void check_image(const Image& image) {
    if (image.width <= 0 || image.height <= 0 || image.data_width <= 0 || image.data_height <= 0)
        throw InputError("", "", "an image has pixels");
    if (image.x0 < 0 || image.y0 < 0 || image.x0 > image.width - image.data_width ||
        image.y0 > image.height - image.data_height)
        throw InputError("", "", "the data window does not lie on the film");
    if (image.channels.empty()) throw InputError("", "channels", "an image has channels");
    std::set<std::string> names;
    for (const Channel& channel : image.channels) {
        if (channel.name.empty()) throw InputError("", "channels", "a channel has a name");
        if (!names.insert(channel.name).second) throw InputError("", channel.name, "is there twice");
        const std::size_t size = channel.is_id() ? channel.ids().size() : channel.floats().size();
        if (size != image.pixels())
            throw InputError("", channel.name, "has not one value per pixel of the data window");
    }
    for (const auto& [name, value] : image.metadata)
        if (name.rfind("trilens:", 0) != 0)
            throw InputError("", name, "names of metadata start with \"trilens:\"");
}

Image read_image(const std::string& file) {
    return read_exr(file);
}

ToneCurve tone_curve(const std::string& name) {
    if (name == "none") return ToneCurve::kLinear;
    if (name == "reinhard") return ToneCurve::kReinhard;
    if (name == "aces") return ToneCurve::kAces;
    if (name == "neutral") return ToneCurve::kNeutral;
    throw UsageError("there is no tone curve \"" + name + "\": none, reinhard, aces, neutral");
}

ImageFormat image_format(const std::string& file) {
    if (file_ending(file) == ".exr") return ImageFormat::kExr;
    if (file_ending(file) == ".png") return ImageFormat::kPng;
    throw UsageError("the image \"" + file + "\" must end in .exr (all channels) or .png (the beauty, sRGB)");
}

void write_image(const std::string& file, const Image& image, const ToneMapping& tone) {
    write_image_as(file, image, image_format(file), tone);
}

void write_image_as(const std::string& file, const Image& image, ImageFormat format,
                    const ToneMapping& tone) {
    check_image(image);
    if (format == ImageFormat::kPng) return replace_file(file, encode_beauty(file, image, tone));
    write_exr(file, image);
}

std::vector<unsigned char> encode_image_as(const Image& image, ImageFormat format, const ToneMapping& tone) {
    check_image(image);
    if (format == ImageFormat::kPng) return encode_beauty("PNG", image, tone);
    return encode_exr("image", image);
}

std::vector<unsigned char> encode_image(const Image& image) {
    return encode_image_as(image, ImageFormat::kExr);
}

}  // namespace trilens
