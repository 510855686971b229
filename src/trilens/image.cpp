#include "trilens/image.h"

#include <set>
#include <utility>

#include "base/util/error.h"
#include "base/util/parallel.h"
#include "image/image_io.h"

namespace trilens {
namespace {

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() > end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

std::vector<float> beauty_of(const Image& image) {
    std::vector<float> rgb(3 * image.pixels());
    int c = 0;
    for (const char* name : {"R", "G", "B"}) {
        const Channel* channel = image.find(name);
        if (!channel || channel->is_id()) throw InputError("", name, "a picture needs R, G and B");
        const std::vector<float>& values = channel->floats();
        for (std::size_t p = 0; p < values.size(); ++p) rgb[3 * p + static_cast<std::size_t>(c)] = values[p];
        ++c;
    }
    return rgb;
}

std::vector<float> shown_beauty(const Image& image, const ToneMapping& tone) {
    check_tone_mapping(tone);
    std::vector<float> rgb = beauty_of(image);
    if (tone.curve == ToneCurve::kLinear && tone.exposure == 0) return rgb;
    parallel_for(rgb.size() / 3, 1 << 14, [&](std::size_t from, std::size_t to) {
        for (std::size_t p = from; p < to; ++p) {
            const Vec3 shown = tone_mapped(Vec3(rgb[3 * p], rgb[3 * p + 1], rgb[3 * p + 2]), tone);
            for (std::size_t c = 0; c < 3; ++c)
                rgb[3 * p + c] = static_cast<float>(shown[static_cast<int>(c)]);
        }
    });
    return rgb;
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
    if (ends_with(file, ".exr")) return ImageFormat::kExr;
    if (ends_with(file, ".png")) return ImageFormat::kPng;
    throw UsageError("the image \"" + file + "\" must end in .exr (all channels) or .png (the beauty, sRGB)");
}

void write_image(const std::string& file, const Image& image, const ToneMapping& tone) {
    write_image_as(file, image, image_format(file), tone);
}

void write_image_as(const std::string& file, const Image& image, ImageFormat format,
                    const ToneMapping& tone) {
    check_image(image);
    if (format == ImageFormat::kPng)
        return write_png(file, image.data_width, image.data_height, shown_beauty(image, tone));
    write_exr(file, image);
}

std::vector<unsigned char> encode_image_as(const Image& image, ImageFormat format, const ToneMapping& tone) {
    check_image(image);
    if (format == ImageFormat::kPng)
        return encode_png(image.data_width, image.data_height, shown_beauty(image, tone));
    return encode_exr("image", image);
}

std::vector<unsigned char> encode_image(const Image& image) {
    return encode_image_as(image, ImageFormat::kExr);
}

}  // namespace trilens
